// One direction of the Gaussian blur of averaged depth. An invocation makes four texels in a row of
// what it reads once.

//#include "view.wgsl"
//#include "halo_types.wgsl"

@group(2) @binding(1) var source: texture_2d<f32>;
@group(2) @binding(2) var result: texture_storage_2d<rgba16float, write>;

fn blur(first: vec2i, axis: vec2i) {
    let last = vec2i(textureDimensions(source)) - 1;
    let reach = i32(ceil(halos.width));
    let sharpness = 2.0 / (halos.width * halos.width);
    var depth = vec4f(0.0);
    var covered = vec4f(0.0);
    var total = vec4f(0.0);
    // of the texel read, in each of the four: they add the same in the same order, wherever a part
    // of the picture begins
    var weights = vec4f(0.0);
    for (var i = -reach; i < reach + 4; i += 1) {
        let away = f32(i);
        weights = vec4f(select(0.0, exp(-sharpness * away * away), i <= reach), weights.xyz);
        let texel = textureLoad(source, clamp(first + i * axis, vec2i(0), last), 0).xy;
        depth += weights * texel.x;
        covered += weights * texel.y;
        total += weights;
    }
    for (var k = 0; k < 4; k += 1) {
        let place = first + k * axis;
        if (all(place <= last)) {
            textureStore(result, place, vec4f(depth[k] / total[k], covered[k] / total[k], 0.0, 1.0));
        }
    }
}

@compute @workgroup_size(8, 8)
fn across(@builtin(global_invocation_id) id: vec3u) {
    blur(vec2i(id.xy) * vec2i(4, 1), vec2i(1, 0));
}

@compute @workgroup_size(8, 8)
fn down(@builtin(global_invocation_id) id: vec3u) {
    blur(vec2i(id.xy) * vec2i(1, 4), vec2i(0, 1));
}
