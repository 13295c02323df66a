// A summed-volume table of extinction (Schlegel et al. 2011), in 32-bit integers: floats would lose
// the small differences of large sums that the table is for. Cubes of a hundred voxels do not overflow.

//#include "volume.wgsl"

@group(2) @binding(0) var<storage, read_write> table: array<u32>;
struct Axis {
    axis: u32,
}
@group(2) @binding(1) var<uniform> along: Axis;

@compute @workgroup_size(64)
fn fill(@builtin(global_invocation_id) id: vec3u) {
    let n = vec3u(volume.size);
    if (any(id >= n)) {
        return;
    }
    let extinction = color_at(table_index(textureLoad(samples, id, 0).r)).w;
    let p = (volume.scene_from_texture * vec4f((vec3f(id) + 0.5) / volume.size, 1.0)).xyz;
    table[(id.z * n.y + id.y) * n.x + id.x] =
        u32(min(extinction, 4.0) * kept_share(p) * 1024.0 + 0.5);
}

// One thread a line of voxels.
@compute @workgroup_size(8, 8)
fn add_up(@builtin(global_invocation_id) id: vec3u) {
    let n = vec3u(volume.size);
    let strides = vec3u(1u, n.x, n.x * n.y);
    let a = select(0u, 1u, along.axis == 0u);
    let b = select(2u, 1u, along.axis == 2u);
    if (id.x >= n[a] || id.y >= n[b]) {
        return;
    }
    var at = id.x * strides[a] + id.y * strides[b];
    var sum = 0u;
    for (var i = 0u; i < n[along.axis]; i++) {
        sum += table[at];
        table[at] = sum;
        at += strides[along.axis];
    }
}
