// Depth and coverage averaged over squares of pixels.

//#include "view.wgsl"
//#include "halo_types.wgsl"

@group(2) @binding(1) var surface: texture_2d<f32>;
@group(2) @binding(3) var nearest: sampler; // nearest
// mean of depth x coverage, mean coverage
@group(2) @binding(2) var result: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= textureDimensions(result))) {
        return;
    }
    let first = id.xy * halos.reduction;
    let scale = 1.0 / vec2f(textureDimensions(surface));
    var sum = vec4f(0.0);
    var covered = vec4f(0.0);
    // squares of four texels; the sampler repeats the last beyond the picture
    for (var y = 1u; y < halos.reduction; y += 2u) {
        for (var x = 1u; x < halos.reduction; x += 2u) {
            let depths = textureGather(3, surface, nearest, vec2f(first + vec2u(x, y)) * scale);
            let seen = step(vec4f(1e-30), depths);
            sum += seen * (depths - view.distance) / halos.jump;
            covered += seen;
        }
    }
    for (var alone = halos.reduction == 1u; alone; alone = false) {
        let depth = textureLoad(surface, first, 0).w;
        covered.x = f32(depth > 0.0);
        sum.x = covered.x * scaled(depth);
    }
    let four = vec4f(1.0);
    let mean = vec2f(dot(sum, four), dot(covered, four)) / f32(halos.reduction * halos.reduction);
    textureStore(result, id.xy, vec4f(mean, 0.0, 1.0));
}
