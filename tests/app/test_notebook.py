"""The viewer in a notebook: a real kernel runs cells, one of which sends what a page would."""

from __future__ import annotations

import base64

import numpy as np
import pytest

nbformat = pytest.importorskip("nbformat", reason="runs a notebook: pip install nbclient ipykernel")
nbclient = pytest.importorskip("nbclient", reason="runs a notebook: pip install nbclient ipykernel")

CELLS = [
    """
import asyncio, base64, time
import numpy as np
import scuro
from scuro.app.notebook import show

canvas = show(scuro.load("sample:1hpv"), size=(320, 200))
canvas
""",
    """
def send(**event):
    canvas._rfb_handle_msg(canvas, {"timestamp": 0.0, **event}, [])

async def rested():
    # as a page: it acknowledges every frame until no more come
    last, still = None, 0
    for _ in range(600):
        await asyncio.sleep(0.05)
        canvas._frame_feedback = {"index": canvas._rfb_frame_index, "timestamp": time.time()}
        frame = canvas._rfb_last_frame
        whole = frame is not None and canvas.scuro.view.complete
        still = still + 1 if whole and last is not None and np.array_equal(frame, last) else 0
        last = frame
        if still > 8:
            return frame
    raise TimeoutError(canvas.scuro.view.status)

canvas._has_visible_views = True
send(type="resize", width=320, height=200, ratio=1.0)
first = await rested()
""",
    """
at = dict(button=1, buttons=[1], modifiers=[], ntouches=0, touches={})
send(type="pointer_down", x=250, y=120, **at)
for step in range(6):
    send(type="pointer_move", x=250 - 12 * step, y=120, **at)
send(type="pointer_up", x=190, y=120, **{**at, "buttons": []})
turned = await rested()
for picture in (first, turned):
    print(base64.b64encode(np.ascontiguousarray(picture[..., :3])).decode(), *picture.shape)
""",
]


@pytest.fixture(scope="module")
def notebook():
    found = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in CELLS])
    nbclient.NotebookClient(found, timeout=120, kernel_name="python3").execute()
    return found


def test_a_cell_shows_a_widget(notebook):
    data = [out.data for out in notebook.cells[0].outputs if out.output_type == "execute_result"]
    assert "application/vnd.jupyter.widget-view+json" in data[0]


def test_the_picture_in_a_cell_turns_as_it_is_dragged(notebook):
    text = "".join(out.text for out in notebook.cells[2].outputs if out.output_type == "stream")
    first, turned = (
        np.frombuffer(base64.b64decode(words[0]), np.uint8).reshape(int(words[1]), int(words[2]), 3)
        for words in (line.split() for line in text.splitlines())
    )
    assert first.shape == turned.shape == (200, 320, 3)
    assert first.std() > 20
    moved = np.abs(first.astype(int) - turned).max(axis=-1) > 30
    assert 0.02 < moved.mean() < 0.9
