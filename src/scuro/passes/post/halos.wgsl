// Halos: how far a pixel lies behind the blurred depth around it (Luft et al. 2006, unsharp masking
// of the depth buffer) gives an opacity that grows with the depth jump and fades with distance on
// the screen. The blurred depth is smooth, so that it is made at a lower resolution.

//#include "halo_types.wgsl"

// blurred depth x coverage, blurred coverage; reduced
@group(2) @binding(8) var blurred: texture_2d<f32>; // filterable
@group(2) @binding(9) var smooth_edges: sampler;

fn halo_strength(pixel: vec2u, depth: f32) -> f32 {
    let place = (vec2f(pixel) + 0.5) / f32(halos.reduction);
    let size = vec2f(textureDimensions(blurred));
    let around = textureSampleLevel(blurred, smooth_edges, place / size, 0.0).xy;
    // a straight edge covers half of the surroundings of the pixels along it
    let behind = select(around.y, scaled(depth) * around.y - around.x, depth > 0.0);
    return halos.opacity * saturate(2.0 * behind);
}
