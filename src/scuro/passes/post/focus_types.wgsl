// What the passes of depth of field share.

struct Focus {
    // distance of what is sharp
    depth: f32,
    // radius in pixels of the circle of confusion where |z - depth| / z (or |z - depth|) is 1
    aperture: f32,
    // largest radius, in pixels
    most: f32,
    perspective: u32,
    taps: u32,
    // tiles that the largest radius reaches
    reach: i32,
}

@group(2) @binding(0) var<uniform> focus: Focus;

// Depth of the background.
const FAR: f32 = 3.0e38;
const TILE: u32 = 8u;

// Radius of the circle of confusion; what is empty spreads nothing.
fn confusion(depth: f32) -> f32 {
    let off = abs(depth - focus.depth);
    let scale = select(1.0, max(depth, 1e-6), focus.perspective != 0u);
    return select(min(focus.aperture * off / scale, focus.most), 0.0, depth >= FAR);
}
