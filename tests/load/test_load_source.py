"""Where bytes come from: samples, standard input, downloads and their cache."""

from __future__ import annotations

import gzip
import io
import subprocess
import sys
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest
from structure_files import MMCIF, MOL, XYZ, pdb_atom

from scuro.errors import LoadError
from scuro.load import fetch, load
from scuro.scene.describe import describe


def test_samples() -> None:
    toxin = load("sample:1tii")
    assert (len(toxin), toxin.name) == (5_684, "1TII")
    assert describe(load("sample:1hpv"))["ligands"] == {"478": 1}


@pytest.mark.parametrize("content", [pdb_atom() * 3, MMCIF, MOL, XYZ])
@pytest.mark.parametrize("pack", [str.encode, lambda text: gzip.compress(text.encode())])
def test_standard_input(monkeypatch: pytest.MonkeyPatch, content: str, pack) -> None:
    class Input:
        buffer = io.BytesIO(pack(content))

    monkeypatch.setattr(sys, "stdin", Input)
    assert len(load("-")) == 3


class _Pdb(BaseHTTPRequestHandler):
    """A PDB that has one entry (which is no BinaryCIF: only its transport is tested) and counts."""

    requests = 0
    body = gzip.compress(b"\x80")

    def do_GET(self) -> None:
        type(self).requests += 1
        if self.path == "/1abc.bcif.gz":
            self.send_response(200)
            self.end_headers()
            self.wfile.write(self.body)
        elif self.path == "/1cut.bcif.gz":
            self.send_response(200)
            self.send_header("Content-Length", "1000")
            self.end_headers()
            self.wfile.write(self.body)
        else:
            self.send_error(503 if self.path == "/1err.bcif.gz" else 404)

    def log_message(self, *_: object) -> None:
        pass


@pytest.fixture
def pdb(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[type[_Pdb]]:
    server = ThreadingHTTPServer(("127.0.0.1", 0), _Pdb)
    _Pdb.requests = 0
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    monkeypatch.setenv("SCURO_PDB_URL", f"http://127.0.0.1:{server.server_port}/")
    monkeypatch.setenv("no_proxy", "127.0.0.1")
    monkeypatch.setattr(fetch, "cache_folder", lambda: tmp_path / "cache")
    yield _Pdb
    server.shutdown()
    thread.join()
    server.server_close()


def test_download_once(pdb: type[_Pdb], tmp_path: Path) -> None:
    path = fetch.fetch("1ABC")
    assert path == tmp_path / "cache" / "1abc.bcif.gz"
    assert path.read_bytes() == pdb.body
    assert fetch.fetch("pdb_00001abc") == path
    assert pdb.requests == 1


@pytest.mark.parametrize(
    ("entry", "said"),
    [("1xyz", "no entry of that ID"), ("1err", "error 503"), ("1cut", "could not be downloaded")],
)
def test_failed_downloads_leave_nothing(pdb, tmp_path: Path, entry: str, said: str) -> None:
    with pytest.raises(LoadError, match=said):
        load(entry)
    assert not (tmp_path / "cache").exists()


def test_no_network(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SCURO_PDB_URL", "http://127.0.0.1:9")
    monkeypatch.setenv("no_proxy", "127.0.0.1")
    monkeypatch.setattr(fetch, "cache_folder", lambda: tmp_path)
    with pytest.raises(LoadError, match="is there a network connection"):
        load("1aon")


def test_a_file_named_like_an_id_wins(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("1abc").write_text(pdb_atom())
    assert len(load("1abc")) == 1


def test_heavy_libraries_stay_out() -> None:
    """A space-filling picture of a PDB file imports neither biotite nor MDAnalysis nor wgpu."""
    code = (
        "import sys; from scuro.load import load; load('sample:1tii').bonds;"
        "print([m for m in ('biotite', 'MDAnalysis', 'wgpu', 'scipy') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
