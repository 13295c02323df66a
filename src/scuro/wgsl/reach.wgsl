// How far techniques of screen space look. What parts of a large picture draw beyond their edges
// covers it, so that no pixel depends on the part that it is drawn in (passes/part.py).

//#include "view.wgsl"

// The radius around a view-space position, cut to what stays within `limit` pixels of its own. A
// step r at depth d shifts by no more than r s / (d - r) pixel widths at distance 1, where s is the
// slant of the ray from the eye.
fn radius_within(radius: f32, position: vec3f, limit: f32) -> f32 {
    let depth = max(-position.z, 1e-9);
    let width = limit * pixel_width(depth);
    if (view.orthographic != 0u) {
        return min(radius, width);
    }
    return min(radius, width / (length(position) / depth + width / depth));
}
