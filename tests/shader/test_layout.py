"""Uniform structs filled by name arrive where WGSL reads them."""

import numpy as np
import pytest
from harness import gpu

from scuro.errors import ShaderError
from scuro.gpu.layout import pack, parse_structs
from scuro.gpu.shader import load_text

SHADER = """
const COUNT: u32 = 3u;
struct Inner { flag: u32, tint: vec3f, weight: f32 }
struct Outer {
    a: f32,
    b: vec2f,
    c: vec3f,
    d: f32,
    turn: mat3x3f,
    place: mat4x4f,
    list: array<vec4f, COUNT>,
    inner: Inner,
    inners: array<Inner, 2>,
    last: vec3i,
}
@group(0) @binding(0) var<uniform> outer: Outer;
@group(0) @binding(1) var<storage, read_write> out: array<f32>;

@compute @workgroup_size(1)
fn main() {
    let turned = outer.turn * vec3f(1.0, 10.0, 100.0);
    let placed = outer.place * vec4f(1.0, 2.0, 3.0, 4.0);
    out[0] = outer.a; out[1] = outer.b.x; out[2] = outer.b.y;
    out[3] = outer.c.x; out[4] = outer.c.y; out[5] = outer.c.z; out[6] = outer.d;
    out[7] = turned.x; out[8] = turned.y; out[9] = turned.z;
    out[10] = placed.x; out[11] = placed.y; out[12] = placed.z; out[13] = placed.w;
    out[14] = outer.list[2].w;
    out[15] = f32(outer.inner.flag); out[16] = outer.inner.tint.y; out[17] = outer.inner.weight;
    out[18] = outer.inners[1].tint.z; out[19] = outer.inners[1].weight;
    out[20] = f32(outer.last.z);
}
"""


def _values():
    rng = np.random.default_rng(1)
    inner = {"flag": 7, "tint": (1, 2, 3), "weight": 0.5}
    return {
        "a": 1.5, "b": (2, 3), "c": (4, 5, 6), "d": 7,
        "turn": rng.normal(size=(3, 3)), "place": rng.normal(size=(4, 4)),
        "list": rng.normal(size=(3, 4)), "inner": inner,
        "inners": [inner, inner | {"tint": (9, 8, -7), "weight": 0.25}], "last": (1, 2, -3),
    }  # fmt: skip


def test_every_field_arrives():
    values = _values()
    out = gpu().buffer(4 * 24)
    gpu().compute(load_text(SHADER, "layout.wgsl"), "main", (1,), {"outer": values, "out": out})
    got = gpu().read_buffer(out)[:21]
    wanted = [
        1.5, 2, 3, 4, 5, 6, 7,
        *(values["turn"] @ [1, 10, 100]), *(values["place"] @ [1, 2, 3, 4]),
        values["list"][2, 3], 7, 2, 0.5, -7, 0.25, -3,
    ]  # fmt: skip
    assert np.allclose(got, wanted, rtol=1e-5, atol=1e-5)


@pytest.mark.parametrize(
    ("change", "words"),
    [({"a": None}, "missing a"), ({"z": 1}, "no field z"), ({"c": (1, 2, 3, 4)}, "has shape")],
)
def test_a_struct_filled_wrongly_is_an_error_that_names_the_file(change, words):
    values = {k: v for k, v in (_values() | change).items() if v is not None}
    with pytest.raises(ShaderError, match=words) as caught:
        pack(parse_structs(SHADER, "layout.wgsl")["Outer"], values, "layout.wgsl", "outer")
    assert "layout.wgsl" in str(caught.value)


def test_a_vector_may_not_be_given_in_part():
    values = _values() | {"c": (4, 5)}
    with pytest.raises(ShaderError, match="has shape"):
        pack(parse_structs(SHADER, "layout.wgsl")["Outer"], values, "layout.wgsl", "outer")


def test_compiler_errors_name_the_included_file_and_line():
    text = (
        '//#include "color.wgsl"\n@compute @workgroup_size(1)\nfn main() {\n    let x = nope;\n}\n'
    )
    with pytest.raises(ShaderError) as caught:
        gpu().compute(load_text(text, "broken.wgsl"), "main", (1,), {})
    assert "broken.wgsl" in str(caught.value) and ":4" in str(caught.value)
    assert "nope" in str(caught.value)
