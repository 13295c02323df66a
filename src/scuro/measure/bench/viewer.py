"""The viewer: frames while turning, delay in the browser, first picture, idle CPU, probe, memory.

A window of 960 × 540 with occlusion and shadows (``--lighting full``). Without inputs the molecule
is copies of the sample 1TII, 60,000 atoms; a second input is what the window opens. What needs a
display runs under ``xvfb-run`` where there is none, and is left out where that is missing, too.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from scuro.measure.bench import BenchOptions, label

SIZE = (960, 540)
_SETTLING = 25
"""Frames until the resolution has found the frame time."""
_SOAK = 20.0
"""Seconds; scripts/soak takes minutes, and says how memory grows after its warm-up."""
_UPDATES = 3000


def run(options: BenchOptions) -> dict[str, Any]:
    """Measure all of it; see the module."""
    with tempfile.TemporaryDirectory() as folder:
        path = _input(options, Path(folder))
        rows = [*_turning(path, options), *_browser(path, options), *_window(options)]
        rows += _soak(options)
    return {"file": label(path), "size": list(SIZE), "rows": rows}


def _row(what: str, value: float, unit: str, target: str = "") -> dict[str, Any]:
    return {"what": what, "value": round(value, 3), "unit": unit, "target": target}


def _input(options: BenchOptions, folder: Path) -> str:
    if options.inputs:
        return options.inputs[0]
    from scuro.measure.bench.process import write_copies

    path = folder / "toxins-60k.cif"
    write_copies(path, 60_000)
    return str(path)


def _screen(path: str, options: BenchOptions) -> Any:
    from scuro.export.scene_file import Input, SceneFile
    from scuro.render import Renderer
    from scuro.viewer.model import Model
    from scuro.viewer.screen import Screen

    model = Model(SceneFile(input=(Input(path=path),), settings=_settings()))
    renderer = Renderer(options.device)
    screen = Screen(model, renderer, "rgba8unorm", lambda name, write: name)
    screen.resize(float(SIZE[0]), float(SIZE[1]), 1.0)
    return screen


def _settings() -> Any:
    from scuro.render_settings import Settings

    return Settings().replace(lighting__preset="full")


def _turning(path: str, options: BenchOptions) -> Iterator[dict[str, Any]]:
    """Frames a second while a hand turns the molecule, the panel drawn beside it."""
    options.say("turning")
    screen = _screen(path, options)
    target = screen.gpu.texture(screen.physical, "rgba8unorm", attachment=True)
    x, y = 300.0, 270.0
    hand = {"event_type": "pointer_down", "x": x, "y": y, "button": 1, "modifiers": ()}
    screen.handle(hand)
    times = []
    for step in range(_SETTLING + 8 * options.frames):
        screen.handle({**hand, "event_type": "pointer_move", "x": x + 3 * step, "button": 0})
        start = time.perf_counter()
        screen.draw(target)
        screen.gpu.finish()
        times.append(time.perf_counter() - start)
    rate = 1 / statistics.median(times[_SETTLING:])
    yield _row("turning", rate, "frames/s", "≥ 10")
    yield _row("turning: slowest frame", 1000 * max(times[_SETTLING:]), "ms")
    yield _row("turning: share of the width drawn", screen.view.pacing.scale, "")
    screen.handle({**hand, "event_type": "pointer_up"})
    slices = []
    begun = time.perf_counter()
    while screen.wait is not None:
        start = time.perf_counter()
        screen.draw(target)
        screen.gpu.finish()
        slices.append(time.perf_counter() - start)
    yield _row("at rest: until complete", time.perf_counter() - begun, "s")
    yield _row("at rest: longest standstill", 1000 * max(slices), "ms")
    screen.close()


# --- in the browser ------------------------------------------------------------------------------


def _browser(path: str, options: BenchOptions) -> list[dict[str, Any]]:
    options.say("the browser")
    command = [sys.executable, "-m", "scuro", "serve", path, "--port", "0", "--lighting", "full"]
    command += ["--device", options.device] if options.device else []
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        assert server.stdout is not None
        address = next((line.strip() for line in server.stdout if line.startswith("http")), "")
        return asyncio.run(_clients(address, options)) if address else []
    finally:
        server.terminate()
        server.wait(20)


async def _clients(address: str, options: BenchOptions) -> list[dict[str, Any]]:
    import aiohttp

    origin = {"Origin": address.rstrip("/")}
    async with (
        aiohttp.ClientSession() as session,
        session.ws_connect(address + "view", headers=origin, max_msg_size=0) as page,
    ):
        delays, longest = await _delays(page, 4 * options.frames)
        await _send(page, "key_down", key="p")
        await _rest(page)
        rate = await _updates(session, address)
    return [
        _row("browser: event to picture, median", 1000 * statistics.median(delays), "ms", "< 250"),
        _row("browser: event to picture, longest", 1000 * max(delays), "ms", "< 250"),
        _row("browser: while it refines, longest", 1000 * longest, "ms", "< 250"),
        _row("probe: updates over WebSocket", rate, "1/s", "≥ 1000"),
    ]


async def _send(page: Any, kind: str, **values: Any) -> None:
    await page.send_str(json.dumps({"type": kind, "modifiers": [], **values}))


async def _picture(page: Any) -> bool:
    """Take one picture; whether it is the full one."""
    header = json.loads(await page.receive_str(timeout=60))
    await page.receive_bytes(timeout=60)
    await _send(page, "shown", index=header["index"])
    return bool(header["mimetype"] == "image/png")


async def _rest(page: Any) -> None:
    while not await _picture(page):
        pass


async def _delays(page: Any, count: int) -> tuple[list[float], float]:
    """Seconds from a move to its picture: while turning, and the longest out of refinement."""
    await _send(page, "resize", width=SIZE[0], height=SIZE[1], ratio=1)
    await _rest(page)
    await _send(page, "pointer_move", x=300, y=270, button=0)
    await _send(page, "pointer_down", x=300, y=270, button=1)
    delays = []
    for step in range(_SETTLING + count):
        start = time.perf_counter()
        await _send(page, "pointer_move", x=300 + 3 * step, y=270, button=0)
        await _picture(page)
        delays.append(time.perf_counter() - start)
        await _quiet(page)
    longest = 0.0
    for step in range(6):
        # into the middle of a slice of the resting picture; what was on its way does not count
        await asyncio.sleep(0.4 + 0.07 * step)
        await _quiet(page, 0.001)
        start = time.perf_counter()
        await _send(page, "pointer_move", x=400 + 3 * step, y=270, button=0)
        await _picture(page)
        await _picture(page)
        longest = max(longest, time.perf_counter() - start)
    await _send(page, "pointer_up", x=400, y=270, button=1)
    await _rest(page)
    return delays[_SETTLING:], longest


async def _quiet(page: Any, wait: float = 0.03) -> None:
    """Take what else is on its way."""
    with contextlib.suppress(TimeoutError, asyncio.TimeoutError):
        while True:
            await _once(page, wait)


async def _once(page: Any, wait: float) -> None:
    header = json.loads(await page.receive_str(timeout=wait))
    await page.receive_bytes(timeout=60)
    await _send(page, "shown", index=header["index"])


async def _updates(session: Any, address: str) -> float:
    """Positions sent and forces received a second, one after another, as a device does."""
    async with session.ws_connect(address + "probe") as socket:
        state: dict[str, Any] = {}
        while "position" not in state:  # the first probe waits for its loops to be compiled
            await asyncio.sleep(0.1)
            await socket.send_str("{}")
            state = await socket.receive_json()
        x, y, z = state["position"]
        start = time.perf_counter()
        for step in range(_UPDATES):
            place = [x + 8 * (step / _UPDATES), y + (step % 40) / 10, z]
            await socket.send_str(json.dumps({"target": place}))
            await socket.receive_str()
        return float(_UPDATES / (time.perf_counter() - start))


# --- in a window ---------------------------------------------------------------------------------

_WATCH = """
import sys, time, psutil
from scuro.viewer import screen
draw, begun = screen.Screen.draw, psutil.Process().create_time()
def watched(self, target):
    draw(self, target)
    if self.view.drawn is not None and not hasattr(screen, "seen"):
        self.gpu.finish()
        screen.seen = time.time() - begun
    if self.wait is None and not hasattr(screen, "idle"):
        from rendercanvas.glfw import loop
        screen.idle = time.process_time()
        def end():
            print(screen.seen, (time.process_time() - screen.idle) / 5, flush=True)
            loop.stop()
        loop.call_later(5, end)
screen.Screen.draw = watched
from scuro.app.cli import run
run(["view", *sys.argv[1:]])
"""


def _window(options: BenchOptions) -> list[dict[str, Any]]:
    """From the start of the process to the first picture, and what it costs to wait.

    The second start counts: an installed program has its bytecode, a checkout may not.
    """
    options.say("the window")
    shown = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY") or os.name == "nt"
    virtual = shutil.which("xvfb-run")
    if not shown and sys.platform != "darwin" and virtual is None:
        return []
    head = [] if shown or virtual is None else [virtual, "-a"]
    name = options.inputs[1] if len(options.inputs) > 1 else "sample:1hpv"
    command = [*head, sys.executable, "-c", _WATCH, name]
    command += ["--device", options.device] if options.device else []
    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, "PYTHONPYCACHEPREFIX": folder}
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        for _ in range(2):
            done = subprocess.run(
                command, capture_output=True, text=True, timeout=120, env=environment
            )
    words = done.stdout.split()
    if len(words) != 2:
        return []
    return [
        _row(f"view {label(name)}: start to first picture", float(words[0]), "s", "≤ 3"),
        _row(f"view {label(name)}: CPU when complete", 100 * float(words[1]), "%", "< 5"),
    ]


def _soak(options: BenchOptions) -> list[dict[str, Any]]:
    from scuro.measure.soak import soak

    options.say("random hands")
    screen = _screen("sample:1hpv", options)
    done = soak(screen, _SOAK, warm=False)
    screen.close()
    return [
        _row(f"random hands for {_SOAK:g} s: memory", done.rounds[-1].resident, "MB"),
        _row("random hands: longest standstill", 1000 * done.longest, "ms"),
    ]
