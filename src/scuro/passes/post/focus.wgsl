// Depth of field by gathering: a neighbour's light is spread evenly over its circle of confusion, and
// counts as far as that reaches here. What lies in front is laid over what lies behind by the share
// that it covers. Neighbours on a spiral of the golden angle, turned from pixel to pixel by interleaved
// gradient noise (Jimenez 2014): any nine side by side have turns evenly spread, for focus_calm.wgsl.

//#include "view.wgsl"
//#include "sampling.wgsl"
//#include "focus_types.wgsl"

@group(2) @binding(1) var depths: texture_2d<f32>;
@group(2) @binding(2) var color: texture_2d<f32>;
// largest circle around, a texel a tile
@group(2) @binding(3) var around: texture_2d<f32>;
@group(2) @binding(4) var replaced: texture_storage_2d<rgba16float, write>;

// By the golden angle.
const GOLDEN_TURN: mat2x2f = mat2x2f(-0.73736888, 0.67549029, -0.67549029, -0.73736888);
// A pixel's own radius: its area is 1.
const PIXEL: f32 = 0.5641896;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let size = vec2i(textureDimensions(replaced));
    let pixel = vec2i(id.xy);
    if (any(pixel >= size)) {
        return;
    }
    let depth = textureLoad(depths, pixel, 0).x;
    let own = confusion(depth);
    let reach = textureLoad(around, id.xy / TILE, 0).x + PIXEL;
    // no more taps than there are pixels in the circle, and none where all is sharp
    let count = select(0.0, min(f32(focus.taps), ceil(4.0 * reach * reach)), reach > 1.0);
    let share = reach * reach / max(count, 1.0);
    let place = vec2f(id.xy) + vec2f(view.origin) + 5.588238 * f32(view.seed & 63u);
    let start = 2.0 * PI * fract(52.9829189 * fract(dot(place, vec2f(0.06711056, 0.00583715))));
    var direction = vec2f(cos(start), sin(start));
    let wide = max(own, PIXEL);
    var behind = textureLoad(color, pixel, 0) * (PIXEL * PIXEL / (wide * wide));
    var behind_total = PIXEL * PIXEL / (wide * wide);
    var front = vec4f(0.0);
    var front_total = 0.0;
    for (var i = 0.0; i < count; i += 1.0) {
        let radius = reach * sqrt((i + 0.5) / count);
        let other = clamp(pixel + vec2i(round(radius * direction)), vec2i(0), size - 1);
        direction = GOLDEN_TURN * direction;
        let other_depth = textureLoad(depths, other, 0).x;
        let nearer = other_depth < depth;
        // what lies behind is hidden by a sharp surface: it spreads no wider than this pixel blurs,
        // and what is empty as wide
        let far = select(min(confusion(other_depth), own), own, other_depth >= FAR);
        let spread = max(select(far, confusion(other_depth), nearer), PIXEL);
        let weight = share / (spread * spread) * saturate(spread - radius + 0.5);
        let light = weight * textureLoad(color, other, 0);
        front += select(vec4f(0.0), light, nearer);
        front_total += select(0.0, weight, nearer);
        behind += select(light, vec4f(0.0), nearer);
        behind_total += select(weight, 0.0, nearer);
    }
    let over = min(front_total, 1.0);
    textureStore(replaced, pixel,
        mix(behind / behind_total, front / max(front_total, 1e-6), over));
}
