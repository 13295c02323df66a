// Occlusion and shadows in object space: for each texel of a texture over the volume, the
// transparency of the cone toward the viewer and of those toward the lights (section 3.3.3).

//#include "illumination.wgsl"

struct Bricks {
    size: vec3u,
    width: u32,
    height: u32,
    // whether all texels are wanted, marked or not
    all_texels: u32,
}

@group(2) @binding(8) var<uniform> bricks: Bricks;
@group(2) @binding(9) var<storage, read> marks: array<u32>;
@group(2) @binding(10) var illuminated: texture_storage_3d<rgba16float, write>;

// one workgroup a brick
@compute @workgroup_size(4, 4, 4)
fn main(
    @builtin(workgroup_id) brick: vec3u,
    @builtin(global_invocation_id) texel: vec3u,
) {
    let index = (brick.z * bricks.height + brick.y) * bricks.width + brick.x;
    if (bricks.all_texels == 0u && marks[index] == 0u) {
        return;
    }
    if (any(texel >= bricks.size)) {
        return;
    }
    let uvw = (vec3f(texel) + 0.5) / vec3f(bricks.size);
    let p = (volume.scene_from_texture * vec4f(uvw, 1.0)).xyz;
    textureStore(illuminated, texel, illumination(p));
}
