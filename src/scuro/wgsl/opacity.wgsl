// Which objects a ray meets when some are transparent. An object (one instance of it) counts as one
// film, however many of its atoms a ray passes: it stops a ray with the probability of its opacity,
// decided anew for each ray, so that means over many rays are exact.

//#include "sampling.wgsl"

override HAS_OPACITY: bool = false;

const ANY_PART: u32 = 0u;
const OPAQUE_PART: u32 = 1u;
const TRANSPARENT_PART: u32 = 2u;
// What rays of this pass may meet, if not what they say themselves.
override PART: u32 = ANY_PART;

// what rays meet from here on: everything by chance, only what is opaque, only what is not
var<private> ray_part: u32 = ANY_PART;
// makes decisions differ between rays that are otherwise alike
var<private> ray_chance: u32 = 0u;
// an instance that the ray has passed
var<private> ray_passed: u32 = 0xffffffffu;

// Of an object, from its flags.
fn opacity_of(flags: u32) -> f32 {
    return f32(flags >> 24u) / 255.0;
}

fn meets(origin: vec3f, direction: vec3f, instance: u32, flags: u32) -> bool {
    let opacity = opacity_of(flags);
    let wanted = select(ray_part, PART, PART != ANY_PART);
    if (wanted == OPAQUE_PART) {
        return opacity >= 1.0;
    }
    if (wanted == TRANSPARENT_PART) {
        return opacity < 1.0 && opacity > 0.0 && instance != ray_passed;
    }
    let d = bitcast<vec3u>(direction);
    let o = bitcast<vec3u>(origin);
    let ray = hash(d.x ^ hash(d.y ^ hash(d.z ^ hash(o.x ^ hash(o.y ^ hash(o.z ^ ray_chance))))));
    return unit_float(hash(ray ^ hash(instance))) < opacity;
}
