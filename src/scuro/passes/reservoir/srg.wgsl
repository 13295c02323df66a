// SRG: structured resampled grid (Campagnolo 2021, section 4.1.1). The opacity is that of the value
// times how much of the neighborhood lies in the model.

//#include "march.wgsl"

// value x inside, inside
@group(3) @binding(0) var resampled: texture_3d<f32>; // filterable

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let size = textureDimensions(volume_color);
    if (any(id.xy >= size)) {
        return;
    }
    let ray = scene_ray(vec2f(id.xy) + 0.5);
    let span = ray_span(ray, id.xy);
    let inverse = 1.0 / select(ray.direction, vec3f(1e-20), abs(ray.direction) < vec3f(1e-20));
    let a = (march.light_low - ray.origin) * inverse;
    let b = (march.light_low + 1.0 / march.light_scale - ray.origin) * inverse;
    let enters = min(a, b);
    let leaves = max(a, b);
    let near = max(span.near, max(enters.x, max(enters.y, enters.z)));
    let far = min(span.far, min(leaves.x, min(leaves.y, leaves.z)));
    var sum = Sum(vec3f(0.0), 1.0, sample_after(near));
    loop {
        let t = sample_t(sum.next);
        if (t >= far || sum.transmittance < march.cutoff) {
            break;
        }
        let p = ray.origin + t * ray.direction;
        let texel = textureSampleLevel(
            resampled, trilinear_sampler, (p - march.light_low) * march.light_scale, 0.0);
        if (texel.g > 0.004) {
            let entry = textureLoad(colors, vec2i(entry_of(texel.r / texel.g), 0), 0);
            let opacity = entry.w * texel.g;
            sum.color += sum.transmittance * opacity * entry.rgb * light_at(p);
            sum.transmittance *= 1.0 - opacity;
        }
        sum.next += 1;
    }
    finish(id.xy, sum);
}
