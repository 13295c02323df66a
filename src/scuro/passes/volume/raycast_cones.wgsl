// The volume's picture with cones traced from every sample of every ray (image space).

//#include "march.wgsl"
//#include "lit.wgsl"
//#include "illumination.wgsl"

@group(2) @binding(6) var volume_color: texture_storage_2d<rgba16float, write>;
@group(2) @binding(7) var volume_depth: texture_storage_2d<r32float, write>;

// a sample that contributes less than this is not worth a cone
const LEAST_WEIGHT: f32 = 0.001;

fn light_at(point: Point) -> vec3f {
    if (point.weight < LEAST_WEIGHT) {
        return lit(point, 1.0, vec3f(1.0));
    }
    let light = illumination(point.position);
    return lit(point, light.x, light.yzw);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= march.width || id.y >= march.height) {
        return;
    }
    let result = integrate(id.xy);
    textureStore(volume_color, id.xy, result.color);
    let forward = -view_ray(vec2f(id.xy) + 0.5).direction.z;
    textureStore(volume_depth, id.xy, vec4f(result.t * forward));
}
