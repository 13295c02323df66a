// One axis of a picture by a matrix with short rows.

struct Step {
    axis: u32,
    taps: u32,
    // whether the result is a picture: no light less than none, no more opacity than all
    last: u32,
}

@group(0) @binding(0) var<uniform> step: Step;
// for each place of the result: first index, then weights
@group(0) @binding(1) var weights: texture_2d<f32>;
@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var result: texture_storage_2d<rgba16float, write>;

// depths, which are not mixed
@group(0) @binding(4) var near: texture_2d<f32>;
@group(0) @binding(5) var near_result: texture_storage_2d<r32float, write>;

@compute @workgroup_size(8, 8)
fn along(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= textureDimensions(result))) {
        return;
    }
    let place = id[step.axis];
    let count = i32(textureDimensions(source)[step.axis]);
    var at = i32(textureLoad(weights, vec2u(0u, place), 0).x);
    var sum = vec4f(0.0);
    var from_ = id.xy;
    for (var i = 1u; i <= step.taps; i++) {
        // mirrored at both ends; no row reaches farther than once around
        let inside = ((at % (2 * count)) + 2 * count) % (2 * count);
        from_[step.axis] = u32(min(inside, 2 * count - 1 - inside));
        sum += textureLoad(weights, vec2u(i, place), 0).x * textureLoad(source, from_, 0);
        at++;
    }
    if (step.last != 0u) {
        sum = vec4f(max(sum.rgb, vec3f(0.0)), clamp(sum.a, 0.0, 1.0));
        let ratio = vec2f(textureDimensions(near)) / vec2f(textureDimensions(near_result));
        let nearest = vec2u((vec2f(id.xy) + 0.5) * ratio);
        textureStore(near_result, id.xy, textureLoad(near, nearest, 0));
    }
    textureStore(result, id.xy, sum);
}
