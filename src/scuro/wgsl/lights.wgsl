// Lights and the deferred shading terms.

const DIRECTIONAL: u32 = 0u;
const POINT: u32 = 1u;
const SPOT: u32 = 2u;
const MAX_LIGHTS: u32 = 16u;

// How many lights there are. A constant: lavapipe compiles loops for the value of a uniform that ends
// them, and loses a shader's memory at every dispatch (see picture_interval, which can hide it)
override LIGHT_COUNT: u32 = MAX_LIGHTS;
// Whether any light is a point or a spot.
override LOCAL_LIGHTS: bool = true;

// All in scene space.
struct Light {
    position: vec3f,
    kind: u32,
    // the way the light travels, unit length
    direction: vec3f,
    reach: f32,
    // linear, intensity included
    color: vec3f,
    // layer of the shadow texture, -1 for a light without shadow
    shadow: i32,
    attenuation: vec3f,
    // radius (point, spot) or tangent of the angular radius (directional)
    size: f32,
    cos_full: f32,
    cos_none: f32,
    pad0: f32,
    pad1: f32,
}

struct Lights {
    ambient: vec3f,
    count: u32,
    list: array<Light, MAX_LIGHTS>,
}

// What reaches a point from a light, shadows aside.
struct Incoming {
    // from the point to the light, unit length
    direction: vec3f,
    distance: f32,
    color: vec3f,
}

fn incoming_light(light: Light, position: vec3f) -> Incoming {
    if (!LOCAL_LIGHTS || light.kind == DIRECTIONAL) {
        return Incoming(-light.direction, 3.0e38, light.color);
    }
    let to_light = light.position - position;
    let range = length(to_light);
    let direction = to_light / max(range, 1e-12);
    let fall = light.attenuation.x + range * (light.attenuation.y + range * light.attenuation.z);
    var strength = select(0.0, 1.0 / max(fall, 1e-6), range <= light.reach);
    if (light.kind == SPOT) {
        let c = dot(-direction, light.direction);
        strength *= smoothstep(light.cos_none, light.cos_full, c);
    }
    return Incoming(direction, range, light.color * strength);
}
