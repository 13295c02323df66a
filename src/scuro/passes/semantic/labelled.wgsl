// The regions of the picture's pixels (regions.wgsl), and whether two pixels lie in different ones.

//#include "region.wgsl"

// at level t, at t + 1, the bits of the depth, the normal: what a probe asks, in one fetch
@group(2) @binding(1) var regions: texture_2d<u32>;

struct Labelled {
    labels: vec2u,
    // 0 where there is nothing
    depth: f32,
    // octahedral
    normal: u32,
}

fn labelled_at(pixel: vec2u) -> Labelled {
    let texel = textureLoad(regions, pixel, 0);
    return Labelled(texel.xy, bitcast<f32>(texel.z), texel.w);
}

// From 0 (the same region at both levels) to 1 (different ones), between the levels by the camera.
fn strangeness(one: vec2u, other: vec2u) -> f32 {
    let differs = vec2f(one != other);
    return mix(differs.x, differs.y, levels.blend);
}
