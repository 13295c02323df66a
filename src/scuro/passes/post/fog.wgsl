// Depth cueing: a linear ramp between two depths, as in print.

//#include "tiles.wgsl"

struct Fog {
    // linear, premultiplied
    color: vec4f,
    start: f32,
    // one over the length of the ramp
    density: f32,
    strength: f32,
}

@group(2) @binding(0) var<uniform> fog: Fog;
@group(2) @binding(1) var surface: texture_2d<f32>;
@group(2) @binding(2) var color: texture_2d<f32>;
@group(2) @binding(3) var replaced: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let id = tile_pixel(group, local);
    if (any(id >= textureDimensions(replaced))) {
        return;
    }
    let depth = textureLoad(surface, id, 0).w;
    let amount = fog.strength * saturate((depth - fog.start) * fog.density) * f32(depth > 0.0);
    let clear = textureLoad(color, id, 0);
    textureStore(replaced, id, mix(clear, fog.color * clear.a, amount));
}
