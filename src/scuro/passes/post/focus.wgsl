// Depth of field by gathering: each neighbour counts if its own circle of confusion reaches here.
// Neighbours on a spiral of the golden angle, turned from pixel to pixel.

//#include "view.wgsl"
//#include "sampling.wgsl"

struct Focus {
    // distance of what is sharp
    depth: f32,
    // radius in pixels of the circle of confusion where |z - depth| / z (or |z - depth|) is 1
    aperture: f32,
    // largest radius, in pixels
    most: f32,
    perspective: u32,
    taps: u32,
}

@group(2) @binding(0) var<uniform> focus: Focus;
@group(2) @binding(1) var depths: texture_2d<f32>;
@group(2) @binding(2) var color: texture_2d<f32>;
@group(2) @binding(3) var replaced: texture_storage_2d<rgba16float, write>;

// By the golden angle.
const GOLDEN_TURN = mat2x2f(-0.73736888, 0.67549029, -0.67549029, -0.73736888);
// Depth of the background.
const FAR: f32 = 3.0e38;

fn confusion(depth: f32) -> f32 {
    let off = abs(depth - focus.depth);
    let scale = select(1.0, max(depth, 1e-6), focus.perspective != 0u);
    return min(focus.aperture * off / scale, focus.most);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let size = vec2i(textureDimensions(replaced));
    let pixel = vec2i(id.xy);
    if (any(pixel >= size)) {
        return;
    }
    let depth = textureLoad(depths, pixel, 0).x;
    // an empty pixel has nothing to spread, but nearer surfaces spread over it
    let own = select(confusion(depth), 0.0, depth >= FAR);
    let place = id.xy + vec2u(view.origin);
    let start = 2.0 * PI * unit_float(hash(place.x + hash(place.y + view.seed)));
    var direction = vec2f(cos(start), sin(start));
    var sum = textureLoad(color, pixel, 0);
    var total = 1.0;
    for (var i = 0u; i < focus.taps; i += 1u) {
        let radius = focus.most * sqrt((f32(i) + 0.5) / f32(focus.taps));
        let other = clamp(pixel + vec2i(round(radius * direction)), vec2i(0), size - 1);
        direction = GOLDEN_TURN * direction;
        let other_depth = textureLoad(depths, other, 0).x;
        var spread = confusion(other_depth);
        // what lies behind is hidden by a sharp surface: it spreads no wider than this pixel blurs
        spread = select(spread, min(spread, own), other_depth > depth);
        spread = select(spread, own, other_depth >= FAR);
        let weight = saturate(spread - radius + 1.0) * f32(spread > 0.5);
        sum += weight * textureLoad(color, other, 0);
        total += weight;
    }
    textureStore(replaced, pixel, sum / total);
}
