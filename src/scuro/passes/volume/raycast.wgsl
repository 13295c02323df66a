// The volume's picture; occlusion and shadows, if any, come precomputed from a texture.

//#include "march.wgsl"
//#include "lit.wgsl"

// visibility, and the shadows of three lights
@group(2) @binding(5) var illuminated: texture_3d<f32>; // filterable
// premultiplied linear color, opacity
@group(2) @binding(6) var volume_color: texture_storage_2d<rgba16float, write>;
// depth (-z in view space) at which half of the opacity is reached, 0 where there is none
@group(2) @binding(7) var volume_depth: texture_storage_2d<r32float, write>;

override ILLUMINATED: bool = false;

fn light_at(point: Point) -> vec3f {
    var light = vec4f(1.0);
    if (ILLUMINATED) {
        let at = light_place(point, vec3f(textureDimensions(illuminated)));
        light = textureSampleLevel(illuminated, trilinear, at, 0.0);
    }
    return lit(point, light.x, light.yzw);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    // eight lanes, which software adapters run as one vector, take 4 x 2 pixels: rays so near each
    // other end nearly together
    let block = vec2u((lane >> 3u) & 1u, lane >> 4u) * vec2u(4u, 2u);
    let pixel = 8u * group.xy + block + vec2u(lane & 3u, (lane >> 2u) & 1u);
    if (pixel.x >= march.width || pixel.y >= march.height) {
        return;
    }
    let result = integrate(pixel);
    textureStore(volume_color, pixel, result.color);
    let forward = -view_ray(vec2f(pixel) + 0.5).direction.z;
    textureStore(volume_depth, pixel, vec4f(result.t * forward));
}
