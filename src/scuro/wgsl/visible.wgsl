// The visibility buffer: which primitive of which instance a pixel sees, and whether as a cap.

//#include "trace.wgsl"

// (primitive, instance, frame of its assembly, 1 + clipping plane of a cap)
fn pack_visible(hit: Hit) -> vec4u {
    return vec4u(hit.primitive, hit.instance, hit.frame, hit.cap);
}

// The hit behind a pixel; its distance must be solved again (surface_at does).
fn unpack_visible(texel: vec4u, ray: Ray) -> Hit {
    let cap = texel.w;
    var t = NOTHING;
    if (CLIPPED && cap != 0u) {
        let plane = scene.planes[cap - 1u];
        t = -(dot(plane.xyz, ray.origin) + plane.w) / dot(plane.xyz, ray.direction);
    }
    return Hit(t, texel.x, texel.y, cap, 2.0, texel.z);
}
