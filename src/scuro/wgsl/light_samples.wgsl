// Lights as discs that face the lit point.

//#include "lights.wgsl"
//#include "sampling.wgsl"

// Tangent of the angular radius at which a point sees a light; `default` for lights without a size.
fn light_spread(light: Light, distance: f32, default_spread: f32) -> f32 {
    if (light.size <= 0.0) {
        return default_spread;
    }
    return light.size / select(max(distance, light.size), 1.0, light.kind == DIRECTIONAL);
}

// Direction to a point of the light's disc, from a point u of the unit square.
fn light_direction(light: Light, arriving: Incoming, default_spread: f32, u: vec2f) -> vec3f {
    let radius = sqrt(u.x) * light_spread(light, arriving.distance, default_spread);
    let angle = 2.0 * PI * u.y;
    let at = tangent_frame(arriving.direction) * vec3f(radius * cos(angle), radius * sin(angle), 1.0);
    return normalize(at);
}
