// The largest circle of confusion in each tile of 8 x 8 pixels, and then in all that lie within reach
// of one: so far, and with so many taps, does a pixel look around.

//#include "focus_types.wgsl"

@group(2) @binding(1) var source: texture_2d<f32>;
@group(2) @binding(2) var result: texture_storage_2d<r32float, write>;

// `source` is the depth.
@compute @workgroup_size(8, 8)
fn largest(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= textureDimensions(result))) {
        return;
    }
    let last = textureDimensions(source) - 1u;
    var most = 0.0;
    for (var i = 0u; i < TILE * TILE; i += 1u) {
        let pixel = min(id.xy * TILE + vec2u(i % TILE, i / TILE), last);
        most = max(most, confusion(textureLoad(source, pixel, 0).x));
    }
    textureStore(result, id.xy, vec4f(most));
}

// `source` is the largest of each tile.
fn spread(tile: vec2i, axis: vec2i) -> f32 {
    let last = vec2i(textureDimensions(source)) - 1;
    var most = 0.0;
    for (var i = -focus.reach; i <= focus.reach; i += 1) {
        let found = textureLoad(source, clamp(tile + i * axis, vec2i(0), last), 0).x;
        // it counts only as far as it reaches
        most = max(most, select(0.0, found, found + f32(TILE) > f32(abs(i) * i32(TILE))));
    }
    return most;
}

@compute @workgroup_size(8, 8)
fn across(@builtin(global_invocation_id) id: vec3u) {
    if (all(id.xy < textureDimensions(result))) {
        textureStore(result, id.xy, vec4f(spread(vec2i(id.xy), vec2i(1, 0))));
    }
}

@compute @workgroup_size(8, 8)
fn down(@builtin(global_invocation_id) id: vec3u) {
    if (all(id.xy < textureDimensions(result))) {
        textureStore(result, id.xy, vec4f(spread(vec2i(id.xy), vec2i(0, 1))));
    }
}
