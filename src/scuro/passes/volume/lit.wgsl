// The light that reaches a sample: ambient x visibility + each light x its shadow.

//#include "rays.wgsl"
//#include "lamps.wgsl"

struct Shading {
    diffuse: f32,
    specular: f32,
    shininess: f32,
    // gradients shorter than this, in values per voxel edge, have no direction worth shading by
    flat: f32,
}

// Blinn-Phong; otherwise samples glow with their own color, dimmed by occlusion and shadow.
// Constants, since software adapters run both sides of a branch.
override PHONG: bool = false;
override SHADOWED: bool = false;

@group(2) @binding(3) var<uniform> shading: Shading;

// `open` is the ambient visibility, `shadow` those of the lights of shadow layers 0, 1 and 2.
fn lit(point: Point, open: f32, shadow: vec3f) -> vec3f {
    var sum = lights.ambient * open;
    if (!PHONG) {
        if (!SHADOWED) {
            return vec3f(open);
        }
        var most = lights.ambient;
        for (var i = 0u; i < LIGHT_COUNT + (i >> 31u); i++) {
            let arriving = incoming_light(lights.list[i], point.position);
            sum += arriving.color * layer_of(lights.list[i], shadow);
            most += lights.list[i].color;
        }
        // a sample that is open and lit keeps its color
        return sum / max(dot(most, vec3f(1.0 / 3.0)), 1e-6);
    }
    var normal = point.cut_normal;
    var strength = 1.0;
    if (all(normal == vec3f(0.0))) {
        let gradient = gradient_at(point.uvw);
        let steepness = length(gradient);
        normal = gradient / max(steepness, 1e-12);
        // inside uniform matter there is no surface: light falls off to an unshaded mean
        strength = smoothstep(0.0, shading.flat, steepness * volume.voxel);
    }
    normal *= select(1.0, -1.0, dot(normal, point.direction) > 0.0);
    for (var i = 0u; i < LIGHT_COUNT + (i >> 31u); i++) {
        let arriving = incoming_light(lights.list[i], point.position);
        let facing = max(dot(normal, arriving.direction), 0.0);
        let between = normalize(arriving.direction - point.direction);
        let shine = shading.specular * pow(max(dot(normal, between), 0.0), shading.shininess)
            * smoothstep(0.0, 0.2, facing);
        let answer = mix(0.5, shading.diffuse * facing + shine, strength);
        sum += arriving.color * layer_of(lights.list[i], shadow) * answer;
    }
    return sum;
}

fn layer_of(light: Light, shadow: vec3f) -> f32 {
    if (light.shadow < 0 || light.shadow > 2) {
        return 1.0;
    }
    return shadow[light.shadow];
}
