// What the passes of a halo share.

struct Halos {
    // linear
    color: vec3f,
    opacity: f32,
    // reach in reduced pixels
    width: f32,
    // depth jump of the strongest halo
    jump: f32,
    // pixels a side of those averaged before the blur
    reduction: u32,
}

@group(2) @binding(7) var<uniform> halos: Halos;

// Depth in units of the jump, from the middle of the scene: fits a half float.
fn scaled(depth: f32) -> f32 {
    return (depth - view.distance) / halos.jump;
}
