// Deferred shading in linear color: ambient x visibility + each light x its shadow. Occlusion never
// darkens the directly lit part: that is the shadows' task.

//#include "view.wgsl"
//#include "tiles.wgsl"
//#include "scene.wgsl"
//#include "lights.wgsl"

@group(2) @binding(0) var<uniform> lights: Lights;
@group(2) @binding(1) var surface: texture_2d<f32>;
@group(2) @binding(2) var albedo: texture_2d<f32>;
@group(2) @binding(3) var ids: texture_2d<u32>;
// 1 = open
@group(2) @binding(4) var visibility: texture_2d<f32>;
// 1 = lit, one layer a shadow-casting light
@group(2) @binding(5) var shadow: texture_2d_array<f32>;
// linear, premultiplied by alpha
@group(2) @binding(6) var color: texture_storage_2d<rgba16float, write>;

override HAS_OCCLUSION: bool = false;
override HAS_SHADOWS: bool = false;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let id = tile_pixel(group, local);
    let size = textureDimensions(color);
    if (any(id >= size)) {
        return;
    }
    let texel = textureLoad(surface, id, 0);
    if (texel.w <= 0.0) {
        textureStore(color, id, vec4f(0.0));
        return;
    }
    let pixel = vec2f(id) + 0.5;
    let base = textureLoad(albedo, id, 0).rgb;
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
    textureStore(color, id, vec4f(sum, 1.0));
}
