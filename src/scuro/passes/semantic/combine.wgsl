// Pass 8: color x occlusion x shadow + bounce.

//#include "seen.wgsl"

@group(2) @binding(1) var albedo: texture_2d<f32>;
@group(2) @binding(2) var gathered: texture_2d<f32>;
// its alpha is the shadow, 1 = lit
@group(2) @binding(3) var bounce: texture_2d<f32>;
// linear, premultiplied by alpha
@group(2) @binding(4) var color: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let here = seen(group, local);
    if (here.outside || here.empty) {
        return;
    }
    let base = textureLoad(albedo, here.pixel, 0).rgb;
    let beside = textureLoad(bounce, here.pixel, 0);
    let light = textureLoad(gathered, here.pixel, 0).rgb * beside.a + beside.rgb;
    textureStore(color, here.pixel, vec4f(base * light, 1.0));
}
