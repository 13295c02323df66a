// Weights that keep edges: they fall with the distance from a pixel's tangent plane and with the
// angle between normals, so that neither silhouettes nor the creases between atoms are blurred.

//#include "view.wgsl"
//#include "scene.wgsl"

struct Center {
    position: vec3f,
    // in view space, where positions are, and in scene space, as the G-buffer has normals
    normal_view: vec3f,
    normal: vec3f,
    // one over the distance from the tangent plane, and over 1 - cosine between normals, beyond
    // which another pixel counts for nothing
    sharpness: vec2f,
}

// `tolerance` in typical radii; `selective` is 1 for noisy values, more for those of more samples.
// The smaller solids are in the picture, the less a pixel's normal says of its surroundings, and what
// a pixel itself spans never counts as another surface.
fn center_at(pixel: vec2i, texel: vec4f, tolerance: f32, selective: f32) -> Center {
    let width = pixel_width(texel.w);
    return Center(
        view_position(vec2f(pixel) + 0.5, texel.w),
        (view.view_from_scene * vec4f(texel.xyz, 0.0)).xyz,
        texel.xyz,
        vec2f(
            1.0 / (2.0 * (tolerance * scene.primitive_radius + width)),
            clamp(scene.primitive_radius / width, 0.5, 4.0) * selective,
        ),
    );
}

fn edge_weight(center: Center, pixel: vec2i, texel: vec4f) -> f32 {
    let apart = view_position(vec2f(pixel) + 0.5, texel.w) - center.position;
    let off = dot(center.normal_view, apart) * center.sharpness.x;
    let turn = 1.0 - (1.0 - dot(center.normal, texel.xyz)) * center.sharpness.y;
    let w = max(1.0 - off * off, 0.0) * max(turn, 0.0);
    return select(0.0, w * w, texel.w > 0.0);
}
