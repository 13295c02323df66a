"""Evaluates a WGSL function over rows of inputs in a compute shader, and returns numpy.

    evaluate("ray.wgsl", "sphere_span(Ray(a.xyz, b.xyz), c.xyz, c.w)", a=..., b=..., c=...)

Each keyword is an array (n, 1 to 4); in the expression it is a ``vec4f`` of that row, zero-padded.
The expression's value becomes row i of the result through ``result``, an expression of ``value``.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scuro.gpu import Gpu
from scuro.gpu.shader import load_text

_BODY = """
{includes}
{functions}
struct Rows {{ count: u32 }}
@group(3) @binding(0) var<uniform> rows: Rows;
@group(3) @binding(1) var<storage, read> inputs: array<vec4f>;
@group(3) @binding(2) var<storage, read_write> outputs: array<vec4f>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {{
    let i = id.x;
    if (i >= rows.count) {{
        return;
    }}
    {arguments}
    let value = {expression};
    outputs[i] = {result};
}}
"""


@cache
def gpu() -> Gpu:
    return Gpu()


def evaluate(
    include: str,
    expression: str,
    *,
    result: str = "vec4f(value)",
    resources: dict[str, Any] | None = None,
    constants: dict[str, float] | None = None,
    functions: str = "",
    **arguments: NDArray,
) -> NDArray[np.float32]:
    """Rows (n, 4) of ``result`` for rows of arguments.

    Args:
        include: File of ``scuro/wgsl``.
        expression: WGSL over the arguments' names and ``i``, the row.
        result: WGSL that makes a ``vec4f`` of ``value``.
        resources: What the included file wants bound.
        constants: Values of its ``override`` constants.
        functions: WGSL that the expression may call.
        arguments: (n, 1 to 4) each, by name; integers keep their bits (``bitcast<u32>(x.x)``).
    """
    count = len(next(iter(arguments.values())))
    table = np.zeros((count, len(arguments), 4), np.float32)
    for column, values in enumerate(arguments.values()):
        values = np.asarray(values)
        if values.dtype.kind in "iu":
            values = values.astype(np.uint32).view(np.float32)
        values = values.reshape(count, -1)
        table[:, column, : values.shape[1]] = values
    names = "\n    ".join(
        f"let {name} = inputs[i * {len(arguments)}u + {column}u];"
        for column, name in enumerate(arguments)
    )
    text = _BODY.format(
        includes=f'//#include "{include}"',
        functions=functions,
        arguments=names,
        expression=expression,
        result=result,
    )
    outputs = gpu().buffer(16 * count)
    gpu().compute(
        load_text(text, "harness.wgsl"),
        "main",
        (count,),
        {"rows": {"count": count}, "inputs": gpu().buffer(table), "outputs": outputs}
        | (resources or {}),
        constants,
    )
    return gpu().read_buffer(outputs).reshape(-1, 4)[:count]
