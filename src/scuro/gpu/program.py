"""Pipelines, compiled lazily and kept; resources bound by the names the shader declares."""

from __future__ import annotations

import re
import threading
import weakref
from collections import OrderedDict
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Any

from scuro.errors import ShaderError
from scuro.gpu.layout import pack
from scuro.gpu.shader import Source, load

if TYPE_CHECKING:
    from scuro.gpu.gpu import Gpu


class Program:
    """A pipeline and the layout of what it wants bound."""

    def __init__(self, source: Source, layouts: list[Any], pipeline: Any, module: Any) -> None:
        self.source = source
        self.pipeline = pipeline
        self._module = module  # kept for other pipelines of the same text
        self.name = PurePosixPath(source.file).stem
        self._layouts = layouts
        self._groups: dict[tuple, tuple[Any, list[weakref.ref[Any]]]] = {}

    def bind(self, gpu: Gpu, resources: Mapping[str, Any]) -> list[Any]:
        """One bind group for each ``@group``, from resources by name."""
        groups = []
        for index, layout in enumerate(self._layouts):
            bindings = [b for b in self.source.bindings if b.group == index]
            held = [self._resource(gpu, binding, resources) for binding in bindings]
            key = (index, *map(id, held))
            if key not in self._groups:
                if len(self._groups) > 64:
                    self._groups.clear()
                entries = [
                    {"binding": binding.slot, "resource": _bound(binding, value)}
                    for binding, value in zip(bindings, held, strict=True)
                ]
                group = gpu.device.create_bind_group(layout=layout, entries=entries)
                self._groups[key] = (group, [weakref.ref(h, self._forget(key)) for h in held])
            groups.append(self._groups[key][0])
        return groups

    def _forget(self, key: tuple) -> Callable[[Any], None]:
        """Drops a group when a resource goes: nothing is kept alive only because it was bound once,
        and its identity may be another's next."""
        groups = self._groups

        def forget(_: Any) -> None:
            groups.pop(key, None)

        return forget

    def _resource(self, gpu: Gpu, binding: Any, resources: Mapping[str, Any]) -> Any:
        if binding.name not in resources:
            raise ShaderError(self.source.file, None, f"nothing is bound to '{binding.name}'")
        value = resources[binding.name]
        if binding.space == "uniform" and isinstance(value, Mapping):
            kind = self.source.structs.get(binding.type.strip())
            if kind is None:
                raise ShaderError(
                    self.source.file, None, f"uniform '{binding.name}' must be a struct of numbers"
                )
            return gpu.uniform(pack(kind, value, self.source.file, binding.name))
        return value


def _bound(binding: Any, value: Any) -> Any:
    """What a bind group takes for a buffer, texture, view or sampler."""
    if binding.space:
        return {"buffer": value, "offset": 0, "size": value.size}
    return _view(value, binding.type) if hasattr(value, "create_view") else value


def _view(texture: Any, type: str) -> Any:
    if "_array" in type:
        return texture.create_view(dimension="2d-array")
    if "storage" in type and texture.mip_level_count > 1:
        return texture.create_view(mip_level_count=1)
    return texture.create_view()


MOST_PROGRAMS = 128
"""Pipelines that are kept, the last used: a picture takes some thirty, but a person who tries every
technique thousands, and lavapipe holds 4 MB for each."""


class Programs:
    """The pipelines of one device."""

    def __init__(self, device: Any) -> None:
        self._device = device
        self._modules: weakref.WeakValueDictionary[str, Any] = weakref.WeakValueDictionary()
        self._layouts: dict[tuple, Any] = {}
        self._of_sources: dict[tuple[str, bool], list[Any]] = {}
        self._programs: OrderedDict[tuple, Program] = OrderedDict()
        self._patience = threading.local()
        self._coming: dict[tuple, Future[Program]] = {}
        self._maker = ThreadPoolExecutor(1, "pipelines")

    @property
    def count(self) -> int:
        """How many pipelines are kept."""
        return len(self._programs)

    def compute(self, shader: str | Source, entry: str, constants: Mapping[str, float]) -> Program:
        """The compute program of an entry point with given ``override`` values.

        Constants that the shader does not declare are left out, so that a frame's can be given
        whole.
        """
        source = load(shader) if isinstance(shader, str) else shader
        constants = {k: v for k, v in constants.items() if k in source.overrides}
        key = (source.text, entry, tuple(sorted(constants.items())))
        if entry not in source.workgroups:
            raise ShaderError(source.file, None, f"there is no compute entry point '{entry}'")
        layouts = self._bind_layouts(source, compute=True)

        def make() -> Program:
            module = self._module(source)
            pipeline = self._device.create_compute_pipeline(
                layout=self._device.create_pipeline_layout(bind_group_layouts=layouts),
                compute={"module": module, "entry_point": entry, "constants": dict(constants)},
            )
            return Program(source, layouts, pipeline, module)

        return self._found(key, source, make)

    def render(
        self,
        shader: str | Source,
        entries: tuple[str, str],
        formats: tuple[str, ...],
        depth: str | None,
        constants: Mapping[str, float],
        topology: str,
        blend: dict | None,
    ) -> Program:
        """The render program of two entry points for given target formats."""
        source = load(shader) if isinstance(shader, str) else shader
        constants = {k: v for k, v in constants.items() if k in source.overrides}
        key = (
            source.text, entries, formats, depth, tuple(sorted(constants.items())), topology,
            repr(blend),
        )  # fmt: skip
        layouts = self._bind_layouts(source, compute=False)
        target = {"blend": blend} if blend else {}

        def make() -> Program:
            module = self._module(source)
            constant = dict(constants)
            pipeline = self._device.create_render_pipeline(
                layout=self._device.create_pipeline_layout(bind_group_layouts=layouts),
                vertex={"module": module, "entry_point": entries[0], "constants": constant},
                primitive={"topology": topology},
                depth_stencil={
                    "format": depth,
                    "depth_write_enabled": True,
                    "depth_compare": "greater",
                }
                if depth
                else None,
                fragment={
                    "module": module,
                    "entry_point": entries[1],
                    "constants": constant,
                    "targets": [{"format": f, **target} for f in formats],
                },
            )
            return Program(source, layouts, pipeline, module)

        return self._found(key, source, make)

    @contextmanager
    def patiently(self, wait: Callable[[Future[Program]], None]) -> Iterator[None]:
        """Within it, in this thread, pipelines that are missing are made beside the caller.

        Args:
            wait: Told of each; has to return when it is done, and may draw something else before.
        """
        self._patience.wait = wait
        try:
            yield
        finally:
            del self._patience.wait

    def _found(self, key: tuple, source: Source, make: Callable[[], Program]) -> Program:
        """The program of a key, made if it is not there."""
        wait = getattr(self._patience, "wait", None)
        try:
            if key not in self._programs and (wait or key in self._coming):
                # a frame that is given up leaves its pipeline to the next
                future = self._coming.get(key) or self._coming.setdefault(
                    key, self._maker.submit(make)
                )
                if wait:
                    wait(future)
                self._coming.pop(key, None)
                self._keep(key, future.result())
            elif key not in self._programs:
                self._keep(key, make())
        except ShaderError:
            raise
        except Exception as error:
            raise _explained(source, error) from None
        self._programs.move_to_end(key)
        return self._programs[key]

    def _keep(self, key: tuple, program: Program) -> None:
        self._programs[key] = program
        while len(self._programs) > MOST_PROGRAMS:
            self._programs.popitem(last=False)

    def _module(self, source: Source) -> Any:
        module = self._modules.get(source.text)
        if module is None:
            try:
                module = self._modules[source.text] = self._device.create_shader_module(
                    code=source.text, label=source.file
                )
            except Exception as error:
                raise _explained(source, error) from None
        return module

    def _bind_layouts(self, source: Source, *, compute: bool) -> list[Any]:
        key = (source.text, compute)
        if key not in self._of_sources:
            self._of_sources[key] = self._new_layouts(source, compute)
        return self._of_sources[key]

    def _new_layouts(self, source: Source, compute: bool) -> list[Any]:
        import wgpu

        stage = wgpu.ShaderStage.COMPUTE
        if not compute:
            stage = wgpu.ShaderStage.VERTEX | wgpu.ShaderStage.FRAGMENT
        count = max((b.group for b in source.bindings), default=-1) + 1
        layouts = []
        for group in range(count):
            entries = []
            for b in source.bindings:
                if b.group != group:
                    continue
                visibility = stage
                if not compute and ("read_write" in b.space or "texture_storage" in b.type):
                    visibility = wgpu.ShaderStage.FRAGMENT
                entries.append({"binding": b.slot, "visibility": visibility, **b.layout()})
            key = (compute, repr(entries))
            if key not in self._layouts:
                self._layouts[key] = self._device.create_bind_group_layout(entries=entries)
            layouts.append(self._layouts[key])
        return layouts


def _explained(source: Source, error: Exception) -> ShaderError:
    """The compiler's words with the line of the file that was written, not of the flat text."""
    text = str(error)
    match = re.search(r"wgsl:(\d+):(\d+)", text) or re.search(r":(\d+):(\d+)", text)
    why = next(
        (line.strip() for line in text.splitlines() if "error" in line.lower() and ":" in line),
        text.strip().splitlines()[0] if text.strip() else type(error).__name__,
    )
    detail = [line.strip(" │|") for line in text.splitlines() if "^" in line or "Caused" in line]
    if detail:
        why = f"{why} ({'; '.join(d for d in detail if d)[:300]})"
    if "Validation" in text or match is None:
        why = re.sub(r"\s+", " ", text)[:800]
    if match:
        file, line = source.where(int(match.group(1)))
        return ShaderError(file, line, why)
    return ShaderError(source.file, None, why)
