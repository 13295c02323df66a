// Halos: how far a pixel lies behind the blurred depth around it (Luft et al. 2006, unsharp masking
// of the depth buffer) gives an opacity that grows with the depth jump and fades with distance on
// the screen. The blurred depth is smooth, so that it is made at a lower resolution.

//#include "halo_types.wgsl"

// blurred depth x coverage, blurred coverage; reduced
@group(2) @binding(8) var blurred: texture_2d<f32>;

fn halo_strength(pixel: vec2u, depth: f32) -> f32 {
    // Between four reduced pixels by hand: the last bits of a sampler's weights depend on where the
    // part begins that is drawn, these do not, for reductions are powers of two. FXAA, which decides
    // by thresholds, would make visible differences of them.
    let place = (vec2f(pixel) + 0.5) / f32(halos.reduction) + 0.5;
    let corner = floor(place);
    let after = place - corner;
    let before = 1.0 - after;
    let at = corner / vec2f(textureDimensions(blurred));
    let depths = textureGather(0, blurred, nearest, at);
    let covered = textureGather(1, blurred, nearest, at);
    let shares = vec4f(before.x, after.x, after.x, before.x)
        * vec4f(after.y, after.y, before.y, before.y);
    // a straight edge covers half of the surroundings of the pixels along it
    let behind = select(covered, scaled(depth) * covered - depths, depth > 0.0);
    return halos.opacity * saturate(2.0 * dot(behind, shares));
}
