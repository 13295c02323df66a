// Depth and coverage averaged over squares of pixels.

//#include "view.wgsl"
//#include "halo_types.wgsl"

@group(2) @binding(1) var surface: texture_2d<f32>;
// mean of depth x coverage, mean coverage
@group(2) @binding(2) var result: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= textureDimensions(result))) {
        return;
    }
    let last = textureDimensions(surface) - 1u;
    var sum = vec2f(0.0);
    for (var y = 0u; y < halos.reduction; y += 1u) {
        for (var x = 0u; x < halos.reduction; x += 1u) {
            let depth = textureLoad(surface, min(id.xy * halos.reduction + vec2u(x, y), last), 0).w;
            sum += select(vec2f(0.0), vec2f(scaled(depth), 1.0), depth > 0.0);
        }
    }
    let mean = sum / f32(halos.reduction * halos.reduction);
    textureStore(result, id.xy, vec4f(mean, 0.0, 1.0));
}
