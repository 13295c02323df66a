// One direction of the Gaussian blur of averaged depth.

//#include "view.wgsl"
//#include "halo_types.wgsl"

@group(2) @binding(1) var source: texture_2d<f32>;
@group(2) @binding(2) var result: texture_storage_2d<rgba16float, write>;

fn blur(pixel: vec2i, axis: vec2i) -> vec4f {
    let last = vec2i(textureDimensions(source)) - 1;
    let reach = i32(ceil(halos.width));
    let sharpness = 2.0 / (halos.width * halos.width);
    var sum = textureLoad(source, pixel, 0).xy;
    var total = 1.0;
    // exp(-sharpness i^2), each from the one before
    var weight = 1.0;
    var ratio = exp(-sharpness);
    let falling = ratio * ratio;
    for (var i = 1; i <= reach; i += 1) {
        weight *= ratio;
        ratio *= falling;
        sum += weight * (textureLoad(source, min(pixel + i * axis, last), 0).xy
            + textureLoad(source, max(pixel - i * axis, vec2i(0)), 0).xy);
        total += 2.0 * weight;
    }
    return vec4f(sum / total, 0.0, 1.0);
}

@compute @workgroup_size(8, 8)
fn across(@builtin(global_invocation_id) id: vec3u) {
    if (all(id.xy < textureDimensions(result))) {
        textureStore(result, id.xy, blur(vec2i(id.xy), vec2i(1, 0)));
    }
}

@compute @workgroup_size(8, 8)
fn down(@builtin(global_invocation_id) id: vec3u) {
    if (all(id.xy < textureDimensions(result))) {
        textureStore(result, id.xy, blur(vec2i(id.xy), vec2i(0, 1)));
    }
}
