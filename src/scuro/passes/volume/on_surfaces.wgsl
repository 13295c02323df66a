// How much of their light the volume leaves to the surfaces in it and around it: cones from every
// surface pixel, toward the viewer and toward the lights.

//#include "illumination.wgsl"

@group(2) @binding(1) var surface: texture_2d<f32>;
@group(2) @binding(4) var surface_light: texture_storage_2d<r32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= textureDimensions(surface_light))) {
        return;
    }
    let depth = textureLoad(surface, id.xy, 0).w;
    var left = 1.0;
    if (depth > 0.0) {
        let p = scene_position(vec2f(id.xy) + 0.5, depth);
        let light = illumination(p);
        // weighted as the lights are
        var sum = light.x * luminance_of(lights.ambient);
        var total = luminance_of(lights.ambient);
        for (var i = 0u; i < LIGHT_COUNT + (i >> 31u); i++) {
            let strength = luminance_of(lights.list[i].color);
            let layer = lights.list[i].shadow;
            sum += strength * select(1.0, light[1 + max(layer, 0)], layer >= 0 && layer < 3);
            total += strength;
        }
        left = sum / max(total, 1e-6);
    }
    textureStore(surface_light, id.xy, vec4f(left));
}

fn luminance_of(color: vec3f) -> f32 {
    return dot(color, vec3f(0.2126, 0.7152, 0.0722));
}
