// The regions of the picture's pixels (regions.wgsl), and whether two pixels lie in different ones.

//#include "region.wgsl"

// at level t, at t + 1
@group(2) @binding(1) var regions: texture_2d<u32>;

fn labels_at(pixel: vec2u) -> vec2u {
    return textureLoad(regions, pixel, 0).xy;
}

// From 0 (the same region at both levels) to 1 (different ones), between the levels by the camera.
fn strangeness(one: vec2u, other: vec2u) -> f32 {
    let differs = vec2f(one != other);
    return mix(differs.x, differs.y, levels.blend);
}
