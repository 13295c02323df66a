// What is where in a picture, coarsely: ids and depth of one sample in each of few pixels.

struct Look {
    // of the eye's picture, in texels
    size: vec2f,
    // where it ends
    end: f32,
    // of the picture, which is off its camera's axis: the survey is on it
    shift: f32,
}

@group(0) @binding(0) var ids: texture_2d<u32>;
@group(0) @binding(1) var surface: texture_2d<f32>;
@group(0) @binding(2) var surveyed: texture_storage_2d<rgba32uint, write>;
@group(0) @binding(3) var<uniform> look: Look;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let size = textureDimensions(surveyed);
    if (any(id.xy >= size)) {
        return;
    }
    let place = (vec2f(id.xy) + 0.5) * look.size / vec2f(size) + vec2f(look.shift, 0.0);
    if (place.x < 0.0 || place.x >= look.end) {
        textureStore(surveyed, id.xy, vec4u(0u, 0u, 0xffffffffu, 0u));
        return;
    }
    let at = vec2i(place);
    let depth = textureLoad(surface, at, 0).w;
    textureStore(surveyed, id.xy, vec4u(textureLoad(ids, at, 0).xyz, bitcast<u32>(depth)));
}
