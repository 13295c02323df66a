// What clipping planes leave of a ray: they bound it from the start, so culled matter is not hit.

//#include "ray.wgsl"
//#include "scene.wgsl"

// The part of a ray that the clipping planes keep.
struct Kept {
    near: f32,
    far: f32,
    // 1 + index of the plane through which the ray enters
    entry: u32,
}

const ALL_KEPT = Kept(-NOTHING, NOTHING, 0u);

fn kept_interval(ray: Ray) -> Kept {
    var kept = ALL_KEPT;
    if (!CLIPPED) {
        return kept;
    }
    for (var i = 0u; i < scene.plane_count + (i >> 31u); i += 1u) {
        let plane = scene.planes[i];
        let height = dot(plane.xyz, ray.origin) + plane.w;
        let slope = dot(plane.xyz, ray.direction);
        if (slope > 0.0) {
            let t = -height / slope;
            if (t > kept.near) {
                kept.near = t;
                kept.entry = i + 1u;
            }
        } else if (slope < 0.0) {
            kept.far = min(kept.far, -height / slope);
        } else if (height < 0.0) {
            kept.far = -NOTHING;
        }
    }
    return kept;
}

// Whether a surface is the cap of something cut: on a plane, facing what it took away. The kept region
// is convex, so nothing else that is cut can be before it: it is open to all of its hemisphere.
fn on_cap(position: vec3f, normal: vec3f, depth: f32) -> bool {
    var found = false;
    if (CLIPPED) {
        for (var i = 0u; i < scene.plane_count + (i >> 31u); i += 1u) {
            let plane = scene.planes[i];
            let height = dot(plane.xyz, position) + plane.w;
            found |= (dot(plane.xyz, normal) < -0.99999) & (abs(height) < 0.01 + 1e-5 * depth);
        }
    }
    return found;
}
