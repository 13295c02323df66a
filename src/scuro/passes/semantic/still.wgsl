// Where pixels hold many atoms each shows one of them, by chance: a camera that moves by less than a
// pixel shows others. The finished color is spread over the pixels beside it, as a lens would, the
// more the more atoms a pixel's width holds; a picture of atoms stays sharp.

//#include "tiles.wgsl"
//#include "view.wgsl"

struct Still {
    // deviation of the spread, pixels, for each atom that a pixel's width holds
    spread: f32,
    // most of it, pixels
    most: f32,
    // diameter of an atom, scene units
    atom: f32,
}

@group(2) @binding(0) var<uniform> still: Still;
@group(2) @binding(1) var surface: texture_2d<f32>;
// linear, premultiplied by alpha
@group(2) @binding(2) var color: texture_2d<f32>;
@group(2) @binding(3) var replaced: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = tile_pixel(group, local);
    let size = textureDimensions(replaced);
    if (any(pixel >= size)) {
        return;
    }
    let last = vec2i(size) - 1;
    // by distance from the middle: 0, 1 and the root of 2
    let own = textureLoad(color, pixel, 0);
    var beside = vec4f(0.0);
    var across = vec4f(0.0);
    var nearest = NOTHING;
    for (var i = -1; i <= 1; i += 1) {
        for (var k = -1; k <= 1; k += 1) {
            let at = clamp(vec2i(pixel) + vec2i(k, i), vec2i(0), last);
            let there = textureLoad(color, at, 0);
            let far = i * i + k * k;
            beside += select(vec4f(0.0), there, far == 1);
            across += select(vec4f(0.0), there, far == 2);
            let depth = textureLoad(surface, at, 0).w;
            nearest = select(nearest, min(nearest, depth), depth > 0.0);
        }
    }
    // nothing below half an atom a pixel, as in calm.wgsl
    let held = select(0.0, pixel_width(nearest) / still.atom - 0.5, nearest < NOTHING);
    let deviation = clamp(still.spread * held, 1e-3, still.most);
    let weight = exp(-0.5 / (deviation * deviation));
    let sum = own + weight * (beside + weight * across);
    textureStore(replaced, pixel, sum / (1.0 + 4.0 * weight * (1.0 + weight)));
}
