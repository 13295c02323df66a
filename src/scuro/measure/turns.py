"""Techniques compared over views that turn about the axes (Campagnolo 2021, Figure 4.10)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from scuro.measure.compare import Drawn, compare
from scuro.measure.metrics import Scores
from scuro.measure.report import Row
from scuro.measure.variant import Variant
from scuro.render_settings import Settings
from scuro.scene.camera import Camera

if TYPE_CHECKING:
    from rich.table import Table

    from scuro.render import Renderer
    from scuro.scene.scene import Scene

AXES = "XYZ"


@dataclass(frozen=True)
class Turned:
    """All techniques in one view."""

    axis: str
    degrees: float
    rows: list[Row]

    def as_dict(self) -> dict[str, Any]:
        rows = [row.as_dict() for row in self.rows]
        return {"axis": self.axis, "degrees": self.degrees, "techniques": rows}


def turned(camera: Camera, axis: str, degrees: float) -> Camera:
    """The camera that sees things as if they had turned about an axis through its target."""
    angle = np.radians(-degrees)
    c, s = np.cos(angle), np.sin(angle)
    first, second = [n for n in range(3) if n != AXES.index(axis)]
    if axis == "Y":  # right-handed: z turns toward x
        first, second = second, first
    matrix = np.eye(3)
    matrix[first, first] = matrix[second, second] = c
    matrix[first, second], matrix[second, first] = -s, s
    target = np.asarray(camera.target)
    eye = target + matrix @ (np.asarray(camera.position) - target)
    up = matrix @ np.asarray(camera.up)
    return replace(camera, position=tuple(eye.tolist()), up=tuple(up.tolist()))


def centered(camera: Camera, bounds: NDArray, aspect: float) -> Camera:
    """The camera looking the same way at the middle of a box, from where it always fits.

    Args:
        camera: Which way to look.
        bounds: (2, 3) world box.
        aspect: Width over height of the picture.
    """
    middle = np.mean(bounds, axis=0)
    radius = max(float(np.linalg.norm(bounds[1] - bounds[0])) / 2, 1e-6)
    half = np.arctan(np.tan(np.radians(camera.fov) / 2) * min(aspect, 1.0))
    back = camera.view_from_world()[2, :3]
    eye = middle + back * radius / np.sin(half)
    height = 2 * radius / min(aspect, 1.0) if camera.orthographic else None
    return replace(
        camera, position=tuple(eye.tolist()), target=tuple(middle.tolist()), height=height
    )


def views(camera: Camera, count: int) -> Iterator[tuple[str, float, Camera]]:
    """``count`` views of a half turn about each axis: axis, degrees, camera."""
    for axis in AXES:
        for degrees in np.linspace(0, 180, count):
            yield axis, float(degrees), turned(camera, axis, float(degrees))


def compare_turned(
    renderer: Renderer,
    scene: Scene,
    camera: Camera,
    settings: Settings,
    variants: Sequence[Variant],
    reference: Variant,
    count: int,
    *,
    frames: int = 1,
    fit: bool = False,
    on_drawn: Callable[[str, Drawn, Row], None] = lambda view, drawn, row: None,
) -> list[Turned]:
    """Compare in ``count`` views about each axis; see :func:`scuro.measure.compare.compare`.

    The axes go through the scene's middle; all views are from the same distance.

    Args:
        on_drawn: Called after each picture with the view's name.
    """
    found = []
    width, height = settings.size
    camera = centered(camera, scene.bounds(), width / height)
    for axis, degrees, at in views(camera, count):
        name = f"{axis.lower()}-{degrees:03.0f}"
        rows = compare(
            renderer, scene, at, settings, variants, reference,
            frames=frames, fit=fit, on_drawn=partial(on_drawn, name),
        )  # fmt: skip
        found.append(Turned(axis, degrees, rows))
    return found


def means(found: Sequence[Turned]) -> list[Row]:
    """Each technique's mean over all views; an unlimited PSNR counts as 99 dB."""
    rows = []
    for rank, first in enumerate(found[0].rows):
        all_rows = [turn.rows[rank] for turn in found]
        notes = {key: _mean([row.notes[key] for row in all_rows]) for key in first.notes}
        rows.append(
            replace(
                first,
                milliseconds=_mean([row.milliseconds for row in all_rows]),
                object=_mean_scores([row.object for row in all_rows]),
                picture=_mean_scores([row.picture for row in all_rows]),
                image="",
                notes=notes,
            )
        )
    return rows


def _mean(values: Sequence[float]) -> float:
    return float(np.mean(np.minimum(values, 1e300)))


def _mean_scores(all_scores: Sequence[Scores | None]) -> Scores | None:
    scores = [s for s in all_scores if s is not None]
    if not scores:
        return None
    mean = {f.name: _mean([getattr(s, f.name) for s in scores]) for f in fields(Scores)}
    mean["psnr"] = _mean([min(s.psnr, 99.0) for s in scores])
    return Scores(**mean)


def table(found: Sequence[Turned]) -> Table:
    """A rich table with a line for each view: milliseconds, PSNR, SSIM and ΔE of each technique."""
    from rich import box
    from rich.table import Table

    made = Table(title="view by view: ms · PSNR · SSIM · ΔE2000", box=box.SIMPLE_HEAD)
    made.add_column("view", no_wrap=True)
    for row in found[0].rows:
        made.add_column(row.technique, justify="right", no_wrap=True)
    for turn in found:
        made.add_row(f"{turn.axis} {turn.degrees:.0f}°", *map(_cell, turn.rows))
    return made


def _cell(row: Row) -> str:
    if row.object is None:
        return f"{row.milliseconds:.0f}"
    o = row.object
    return f"{row.milliseconds:.0f} · {o.psnr:.1f} · {o.ssim:.3f} · {o.delta_e:.2f}"
