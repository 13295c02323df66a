// What is where in a picture, coarsely: ids and depth of one sample in each of few pixels.

@group(0) @binding(0) var ids: texture_2d<u32>;
@group(0) @binding(1) var surface: texture_2d<f32>;
@group(0) @binding(2) var surveyed: texture_storage_2d<rgba32uint, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let size = textureDimensions(surveyed);
    if (any(id.xy >= size)) {
        return;
    }
    let at = vec2i((vec2f(id.xy) + 0.5) * vec2f(textureDimensions(ids)) / vec2f(size));
    let depth = textureLoad(surface, at, 0).w;
    textureStore(surveyed, id.xy, vec4u(textureLoad(ids, at, 0).xyz, bitcast<u32>(depth)));
}
