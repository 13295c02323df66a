// Occlusion and shadows in object space: for each texel of a texture over the volume, the
// transparency of the cone toward the viewer and of those toward the lights (section 3.3.3).

//#include "illumination.wgsl"

struct Bricks {
    size: vec3u,
    // bricks along x, y and z
    width: u32,
    height: u32,
    depth: u32,
    // whether all bricks are wanted, marked or not
    all_bricks: u32,
    // the part of the listed bricks that a dispatch lights
    first: u32,
    end: u32,
}

@group(2) @binding(8) var<uniform> bricks: Bricks;
@group(2) @binding(9) var<storage, read> marks: array<u32>;
@group(2) @binding(10) var illuminated: texture_storage_3d<rgba16float, write>;
// how many bricks are wanted, then which
@group(2) @binding(11) var<storage, read_write> wanted: array<atomic<u32>>;

@compute @workgroup_size(64)
fn list_bricks(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let count = bricks.width * bricks.height * bricks.depth;
    let index = id.x + id.y * groups.x * 64u;
    if (index < count && (bricks.all_bricks != 0u || marks[index] != 0u)) {
        atomicStore(&wanted[1u + atomicAdd(&wanted[0], 1u)], index);
    }
}

// Each workgroup takes every so-manieth of the listed bricks: a workgroup for each brick would
// cost more for those that are not wanted than for those that are.
@compute @workgroup_size(4, 4, 4)
fn main(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_id) within: vec3u,
) {
    let end = min(bricks.end, atomicLoad(&wanted[0]));
    for (var i = bricks.first + group.x; i < end; i += groups.x) {
        let index = atomicLoad(&wanted[1u + i]);
        let brick = vec3u(index, index / bricks.width, index / (bricks.width * bricks.height))
            % vec3u(bricks.width, bricks.height, 0xffffffffu);
        let texel = brick * 4u + within;
        if (all(texel < bricks.size)) {
            let uvw = (vec3f(texel) + 0.5) / vec3f(bricks.size);
            let p = (volume.scene_from_texture * vec4f(uvw, 1.0)).xyz;
            textureStore(illuminated, texel, illumination(p));
        }
    }
}
