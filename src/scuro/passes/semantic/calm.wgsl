// Where a pixel holds many atoms its one sampled normal is chance: take the mean over the
// neighbours of the same region instead, over as many pixels as it takes atoms to fill one.

//#include "tiles.wgsl"
//#include "view.wgsl"

struct Calm {
    // pixels of smoothing for each atom that a pixel's width holds
    reach: f32,
    // diameter of an atom, scene units
    atom: f32,
    // depths differing more are another surface, scene units
    depth_limit: f32,
}

const MOST: i32 = 5;

@group(2) @binding(0) var<uniform> calm: Calm;
@group(2) @binding(1) var surface: texture_2d<f32>;
@group(2) @binding(2) var regions: texture_2d<u32>;
// as `surface`
@group(2) @binding(3) var calm_surface: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = tile_pixel(group, local);
    let size = textureDimensions(surface);
    if (any(pixel >= size)) {
        return;
    }
    let here = textureLoad(surface, pixel, 0);
    // nothing to smooth below one atom a pixel; grows from there without a jump
    let sigma = calm.reach * max(pixel_width(here.w) / calm.atom - 0.5, 0.0);
    if (here.w <= 0.0 || sigma < 0.05) {
        textureStore(calm_surface, pixel, here);
        return;
    }
    let region = textureLoad(regions, pixel, 0).x;
    let reach = clamp(i32(ceil(2.0 * sigma)), 1, MOST);
    var sum = here.xyz;
    for (var y = -reach; y <= reach; y += 1) {
        for (var x = -reach; x <= reach; x += 1) {
            let at = vec2i(pixel) + vec2i(x, y);
            if (any(at < vec2i(0)) || any(at >= vec2i(size)) || (x == 0 && y == 0)) {
                continue;
            }
            let there = textureLoad(surface, at, 0);
            if (there.w <= 0.0 || textureLoad(regions, at, 0).x != region
                || abs(there.w - here.w) > calm.depth_limit) {
                continue;
            }
            sum += there.xyz * exp(-0.5 * f32(x * x + y * y) / (sigma * sigma));
        }
    }
    let length = max(dot(sum, sum), 1e-12);
    textureStore(calm_surface, pixel, vec4f(sum * inverseSqrt(length), here.w));
}
