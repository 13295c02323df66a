// Deferred shading in linear color: ambient x visibility + each light x its shadow. Occlusion never
// darkens the directly lit part: that is the shadows' task.

//#include "view.wgsl"
//#include "scene.wgsl"
//#include "lights.wgsl"

@group(2) @binding(0) var surface: texture_2d<f32>;
@group(2) @binding(12) var<uniform> lights: Lights;
@group(2) @binding(13) var ids: texture_2d<u32>;
// 1 = open
@group(2) @binding(14) var visibility: texture_2d<f32>;
// 1 = lit, one layer a shadow-casting light
@group(2) @binding(15) var shadow: texture_2d_array<f32>;

override HAS_OCCLUSION: bool = false;
override HAS_SHADOWS: bool = false;

// Light of a pixel, premultiplied by alpha; `texel` is its surface, `base` its linear color.
fn shaded(id: vec2u, texel: vec4f, base: vec3f) -> vec4f {
    if (texel.w <= 0.0) {
        return vec4f(0.0);
    }
    let pixel = vec2f(id) + 0.5;
    let object = textureLoad(ids, id, 0).z;
    let position = scene_position(pixel, texel.w);
    let normal = texel.xyz;
    let to_eye = -scene_ray(pixel).direction;
    let material = material_at(object);

    var open = 1.0;
    if (HAS_OCCLUSION) {
        open = textureLoad(visibility, id, 0).x;
    }
    var sum = base * lights.ambient * open;
    // the sign bit, always 0, hides the uniform's value from lavapipe: see picture_interval
    for (var i = 0u; i < lights.count + (i >> 31u); i += 1u) {
        let light = lights.list[i];
        let arriving = incoming_light(light, position);
        let facing = dot(normal, arriving.direction);
        if (facing <= 0.0) {
            continue;
        }
        var lit = 1.0;
        if (HAS_SHADOWS && light.shadow >= 0) {
            lit = textureLoad(shadow, id, light.shadow, 0).x;
        }
        let between = normalize(arriving.direction + to_eye);
        let shine = material.specular
            * pow(max(dot(normal, between), 0.0), material.shininess);
        sum += lit * arriving.color * (base * material.diffuse * facing + shine * smoothstep(0.0, 0.2, facing));
    }
    return vec4f(sum, 1.0);
}
