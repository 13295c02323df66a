// Depth of field after gathering: where circles are so wide that the taps lie far apart, a pixel is the
// mean of the nine around it, whose taps lie between each other. What is sharp stays as it is.

//#include "focus_types.wgsl"

@group(2) @binding(1) var depths: texture_2d<f32>;
@group(2) @binding(2) var color: texture_2d<f32>;
@group(2) @binding(3) var around: texture_2d<f32>;
@group(2) @binding(4) var replaced: texture_storage_2d<rgba16float, write>;

// Radius in pixels from which on it is done, and from which on in full.
const CALM: vec2f = vec2f(8.0, 12.0);

// How much a pixel takes part: by its own circle, or where it is empty by those that reach it.
fn part(pixel: vec2i) -> f32 {
    let depth = textureLoad(depths, pixel, 0).x;
    let reach = textureLoad(around, vec2u(pixel) / TILE, 0).x;
    return smoothstep(CALM.x, CALM.y, select(confusion(depth), reach, depth >= FAR));
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let size = vec2i(textureDimensions(replaced));
    let pixel = vec2i(id.xy);
    if (any(pixel >= size)) {
        return;
    }
    let own = textureLoad(color, pixel, 0);
    let share = part(pixel);
    var sum = own;
    var total = 1.0;
    // all or none of a tile, and a loop that ends at once is skipped
    let rows = select(0, 9, textureLoad(around, id.xy / TILE, 0).x > CALM.x);
    for (var i = 0; i < rows; i += 1) {
        let other = clamp(pixel + vec2i(i % 3 - 1, i / 3 - 1), vec2i(0), size - 1);
        let weight = select(part(other), 0.0, i == 4);
        sum += weight * textureLoad(color, other, 0);
        total += weight;
    }
    textureStore(replaced, pixel, mix(own, sum / total, share));
}
