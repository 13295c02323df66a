"""The viewer in a real browser: load, drag, set, pick, clip, save; and in a real window."""

import io
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

CHROMIUM = shutil.which("chromium") or shutil.which("google-chrome")
DRIVER = shutil.which("chromedriver")
SIZE = (860, 460)
"""Of the page; the panel takes 330 of its width."""
_FLAGS = (
    "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--hide-scrollbars", "--force-device-scale-factor=1",
)  # fmt: skip
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2] / "src")}


@pytest.fixture(scope="module")
def address():
    """Of a viewer that serves a space-filling protease."""
    pytest.importorskip("imgui_bundle", reason="needs the viewer extra")
    command = [sys.executable, "-m", "scuro", "serve", "sample:1hpv", "--port", "0"]
    command += ["--style", "spacefill", "--color", "chain"]
    server = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=ENVIRONMENT
    )
    try:
        yield server.stdout.readline().strip()
    finally:
        server.terminate()
        server.communicate(timeout=20)


@pytest.fixture(scope="module")
def page(address, tmp_path_factory):
    if CHROMIUM is None or DRIVER is None:
        pytest.skip("needs Debian's packages chromium and chromium-driver")
    webdriver = pytest.importorskip("selenium.webdriver", reason="needs selenium")
    from selenium.webdriver.chrome.service import Service

    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for flag in (*_FLAGS, f"--user-data-dir={tmp_path_factory.mktemp('profile')}"):
        options.add_argument(flag)
    downloads = tmp_path_factory.mktemp("downloads")
    options.add_experimental_option("prefs", {"download.default_directory": str(downloads)})
    driver = webdriver.Chrome(options=options, service=Service(DRIVER))
    try:
        driver.execute_cdp_cmd(
            "Emulation.setDeviceMetricsOverride",
            {"width": SIZE[0], "height": SIZE[1], "deviceScaleFactor": 1, "mobile": False},
        )
        driver.get(address)
        yield Page(driver, downloads)
    finally:
        driver.quit()


class Page:
    """What a person does with the page."""

    def __init__(self, driver, downloads):
        self.driver, self.downloads = driver, downloads
        self.seen = 0

    def _index(self):
        """Number of the picture that is shown, and whether it is the full one."""
        return tuple(
            self.driver.execute_script(
                "const i = document.querySelector('#canvas img');"
                "return i ? [Number(i.dataset.index || 0), i.dataset.full === 'true'] : [0, false]"
            )
        )

    def rested(self, timeout=60):
        """The page's pixels when the full picture after the last act has been there a while."""
        end, last, since = time.time() + timeout, None, time.time()
        while time.time() < end:
            index, full = self._index()
            if (index, full) != last:
                last, since = (index, full), time.time()
            elif full and index > self.seen and time.time() - since > 1.2:
                self.seen = index
                shot = self.driver.get_screenshot_as_png()
                return np.asarray(Image.open(io.BytesIO(shot)).convert("RGB"))
            time.sleep(0.1)
        raise AssertionError("the page never comes to rest")

    def _mouse(self, kind, x, y, button="left", **more):
        self.driver.execute_cdp_cmd(
            "Input.dispatchMouseEvent",
            {"type": kind, "x": x, "y": y, "button": button, "clickCount": 1, **more},
        )
        time.sleep(0.05)

    def click(self, x, y):
        self._mouse("mouseMoved", x, y, "none")
        time.sleep(0.3)
        self._mouse("mousePressed", x, y)
        time.sleep(0.3)
        self._mouse("mouseReleased", x, y)

    def drag(self, start, end):
        self._mouse("mouseMoved", *start, "none")
        time.sleep(0.3)
        self._mouse("mousePressed", *start)
        for share in (0.25, 0.5, 0.75, 1.0):
            x, y = (a + share * (b - a) for a, b in zip(start, end, strict=True))
            self._mouse("mouseMoved", x, y, buttons=1)
        time.sleep(0.3)
        self._mouse("mouseReleased", *end)

    def fingers(self, start, end):
        """Put fingers down one after the other, move them together and lift them."""
        places = [{"x": x, "y": y, "id": n} for n, (x, y) in enumerate(start)]

        def send(kind, points):
            self.driver.execute_cdp_cmd(
                "Input.dispatchTouchEvent", {"type": kind, "touchPoints": points}
            )
            time.sleep(0.1)

        for count in range(1, len(start) + 1):
            send("touchStart", places[:count])
        for share in (0.25, 0.5, 0.75, 1.0):
            moved = [
                {"x": a + share * (c - a), "y": b + share * (d - b), "id": n}
                for n, ((a, b), (c, d)) in enumerate(zip(start, end, strict=True))
            ]
            send("touchMove", moved)
        send("touchEnd", [])

    def key(self, key):
        for kind in ("keyDown", "keyUp"):
            self.driver.execute_cdp_cmd("Input.dispatchKeyEvent", {"type": kind, "key": key})


PANEL = SIZE[0] - 330
"""Where the panel begins."""
PICTURE = (slice(45, 400), slice(130, 520))
"""Rows and columns of the page where only the scene is drawn."""


def changed(a, b):
    """Share of the scene's pixels that differ clearly."""
    return (np.abs(a[PICTURE].astype(int) - b[PICTURE]) > 24).any(axis=-1).mean()


def test_the_page_shows_what_render_draws_and_answers_to_hands(page, tmp_path):
    first = page.rested()
    assert first.shape == (SIZE[1], SIZE[0], 3)
    # the same scene from the command line, at the size the panel leaves
    output = tmp_path / "render.png"
    subprocess.run(
        [sys.executable, "-m", "scuro", "render", "sample:1hpv", "--style", "spacefill",
         "--color", "chain", "--size", f"{SIZE[0] - 330}x{SIZE[1]}", "-o", str(output)],
        check=True, env=ENVIRONMENT, timeout=120,
    )  # fmt: skip
    rendered = np.asarray(Image.open(output).convert("RGB"))
    assert np.abs(first[PICTURE].astype(int) - rendered[PICTURE]).max() <= 1
    assert rendered[PICTURE].std() > 20, "an empty picture"

    page.drag((260, 230), (320, 250))
    turned = page.rested()
    assert changed(first, turned) > 0.1

    # pick: the atom's outline is orange, and its name is written beside the pointer
    page.click(265, 230)
    picked = page.rested()
    orange = (np.abs(picked.astype(int) - (255, 140, 0)) <= 40).all(axis=-1)
    assert 4 < orange[PICTURE].sum() < 4000
    name = (slice(248, 264), slice(282, 360))
    assert (picked[name] < 90).all(axis=-1).sum() > 60, "no name of what is under the pointer"
    assert (picked[name] > 200).all(axis=-1).sum() > 300, "no ground under the name"

    # two fingers shift the picture and turn nothing: the axes stay as they are
    page.fingers([(200, 200), (300, 200)], [(200, 240), (300, 240)])
    shifted = page.rested()
    before, after = (a[380:440, 20:90].astype(int) for a in (picked, shifted))
    drawn = np.ptp(before, axis=-1) > 60
    assert changed(picked, shifted) > 0.1 and drawn.sum() > 50
    assert (np.abs(after - before)[drawn] > 60).any(axis=-1).mean() < 0.1

    picked = shifted
    page.key("c")
    clipped = page.rested()
    assert changed(picked, clipped) > 0.1
    page.driver.execute_cdp_cmd(
        "Input.dispatchKeyEvent", {"type": "keyDown", "key": "z", "modifiers": 2}
    )
    assert changed(picked, page.rested()) < 0.01, "undo does not bring the picture back"

    # the slider 'opacity' of the first representation lies in the panel
    page.drag((PANEL + 183, 226), (PANEL + 60, 226))
    faded = page.rested()
    slider = (slice(218, 236), slice(PANEL + 10, PANEL + 190))
    assert (faded[slider] != picked[slider]).any()

    # the tab and the button that save the picture
    page.click(PANEL + 190, 70)
    page.click(PANEL + 50, 198)
    end = time.time() + 60
    while not list(page.downloads.glob("*.png")) and time.time() < end:
        time.sleep(0.1)
    (saved,) = page.downloads.glob("*.png")
    # a picture that was saved makes itself again on the command line
    again = tmp_path / "again.png"
    subprocess.run(
        [sys.executable, "-m", "scuro", "render", str(saved), "-o", str(again)],
        check=True, env=ENVIRONMENT, timeout=120,
    )  # fmt: skip
    first, second = (np.asarray(Image.open(path)) for path in (saved, again))
    assert first.shape == (SIZE[1], PANEL, 3) and (first == second).all()


def test_the_window_opens_draws_and_closes(tmp_path):
    pytest.importorskip("imgui_bundle", reason="needs the viewer extra")
    pytest.importorskip("glfw", reason="needs the viewer extra")
    if shutil.which("xvfb-run") is None:
        pytest.skip("needs Debian's package xvfb")
    code = """
import time
from rendercanvas.glfw import loop
from scuro.export.scene_file import Input, SceneFile, Show
from scuro.render import Renderer
from scuro.render_settings import Settings
from scuro.viewer.model import Model
from scuro.viewer.window import open_window, run_windows
document = SceneFile(
    input=(Input(path="sample:1hpv"),), show=(Show(style="spacefill"),),
    settings=Settings(size=(700, 300)),
)
screen = open_window(Model(document), Renderer())
start = time.time()
def look():
    if screen.view.share < 1 and time.time() - start < 60:
        loop.call_later(0.2, look)
        return
    drawn = screen.view.drawn
    picture = screen.gpu.read_texture(drawn.resources["picture"])
    print(screen.view.share, picture.shape, picture[..., :3].std() > 20, flush=True)
    loop.stop()
loop.call_later(0.2, look)
run_windows()
"""
    done = subprocess.run(
        ["xvfb-run", "-a", "-s", "-screen 0 1024x768x24", sys.executable, "-c", code],
        capture_output=True, text=True, timeout=120, env=ENVIRONMENT, cwd=tmp_path,
    )  # fmt: skip
    assert done.stdout.strip() == "1.0 (300, 370, 4) True", done.stderr[-2000:]


def test_without_a_display_view_says_what_to_do():
    environment = {k: v for k, v in ENVIRONMENT.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
    done = subprocess.run(
        [sys.executable, "-m", "scuro", "view", "sample:1hpv"],
        capture_output=True, text=True, env=environment, timeout=60,
    )  # fmt: skip
    assert done.returncode == 1
    assert "scuro serve" in done.stderr and "Traceback" not in done.stderr
