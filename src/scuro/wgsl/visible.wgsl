// The visibility buffer: which primitive of which instance a pixel sees, and whether as a cap.

//#include "trace.wgsl"

const INSTANCE_BITS: u32 = 26u;

fn pack_visible(hit: Hit) -> vec2u {
    return vec2u(hit.primitive, hit.instance | (hit.cap << INSTANCE_BITS));
}

// The hit behind a pixel; its distance must be solved again (surface_at does).
fn unpack_visible(texel: vec2u, ray: Ray) -> Hit {
    let cap = texel.y >> INSTANCE_BITS;
    var t = NOTHING;
    if (CLIPPED && cap != 0u) {
        let plane = scene.planes[cap - 1u];
        t = -(dot(plane.xyz, ray.origin) + plane.w) / dot(plane.xyz, ray.direction);
    }
    return Hit(t, texel.x, texel.y & ((1u << INSTANCE_BITS) - 1u), cap, 2.0);
}
