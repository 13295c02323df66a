// One slice of directional occlusion shading (Schott et al. 2009): blur the openness, composite the
// slice's matter under it, take the matter's opacity from the openness.

//#include "lit.wgsl"
//#include "illumination.wgsl"

struct Slice {
    // pixels that may see the volume
    low: vec2u,
    high: vec2u,
    // of the plane, -z in view space, and from one to the next, scene units
    depth: f32,
    spacing: f32,
    // of the disc that the cone cuts out of the plane before, scene units
    radius: f32,
    attenuation: f32,
    first: u32,
}

@group(2) @binding(4) var<uniform> slice: Slice;
@group(2) @binding(5) var openness: texture_2d<f32>;
@group(2) @binding(8) var openness_after: texture_storage_2d<r32float, write>;
// premultiplied linear color, opacity
@group(2) @binding(9) var<storage, read_write> sums: array<vec4f>;
// depth of half the opacity
@group(2) @binding(10) var<storage, read_write> seen: array<f32>;
@group(2) @binding(6) var volume_color: texture_storage_2d<rgba16float, write>;
@group(2) @binding(7) var volume_depth: texture_storage_2d<r32float, write>;

// Mean over the disc: a cross with the disc's own second moment, r^2 / 4 along each axis. After a few
// slices only that moment can be told, and bilinear taps would blur more than the disc.
fn blurred(at: vec2u) -> f32 {
    let r = slice.radius / pixel_width(slice.depth);
    let variance = 0.25 * r * r;
    let reach = max(ceil(sqrt(2.0 * variance)), 1.0);
    let side = 0.5 * variance / (reach * reach);
    let d = i32(reach);
    let low = vec2i(slice.low);
    let high = vec2i(slice.high) - 1;
    let p = vec2i(at);
    let around = textureLoad(openness, clamp(p + vec2i(d, 0), low, high), 0).r
        + textureLoad(openness, clamp(p - vec2i(d, 0), low, high), 0).r
        + textureLoad(openness, clamp(p + vec2i(0, d), low, high), 0).r
        + textureLoad(openness, clamp(p - vec2i(0, d), low, high), 0).r;
    return mix(textureLoad(openness, at, 0).r, 0.25 * around, 4.0 * side);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let pixel = id.xy + slice.low;
    if (any(pixel >= slice.high)) {
        return;
    }
    let open = select(blurred(pixel), 1.0, slice.first != 0u);
    let at = pixel.y * march.width + pixel.x;
    let middle = vec2f(pixel) + 0.5;
    let ray = scene_ray(middle);
    let t = ray_distance(middle, slice.depth);
    let span = crossing(ray);
    var left = open;
    if (t >= span.near && t < min(span.far, surface_limit(pixel))) {
        let p = ray.origin + t * ray.direction;
        let uvw = texture_position(p);
        let index = table_index(value_at(uvw));
        let along = ray_distance(middle, slice.spacing) / volume.voxel;
        let opacity = 1.0 - exp(-color_at(index).w * along);
        if (opacity > 0.0) {
            let before = sums[at];
            let weight = (1.0 - before.a) * opacity;
            if (weight > 0.0) {
                var shown = index;
                if (ISOSURFACE) {
                    shown = table_index(march.iso);
                }
                var cut_normal = vec3f(0.0);
                if (span.cut < volume.cut_count && t - span.near < slice.spacing) {
                    cut_normal = -volume.cuts[span.cut].xyz;
                }
                let point = Point(p, uvw, ray.direction, t, weight, cut_normal, pixel);
                let shadow = illumination(p).yzw;
                let light = lit(point, open, shadow);
                sums[at] = before + vec4f(weight * color_at(shown).rgb * light, weight);
                if (before.a < 0.5 && before.a + weight >= 0.5) {
                    seen[at] = slice.depth;
                }
            }
            left = open * pow(1.0 - opacity, slice.attenuation);
        }
    }
    textureStore(openness_after, pixel, vec4f(left));
}

@compute @workgroup_size(8, 8)
fn finish(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= march.width || id.y >= march.height) {
        return;
    }
    let at = id.y * march.width + id.x;
    textureStore(volume_color, id.xy, sums[at]);
    textureStore(volume_depth, id.xy, vec4f(seen[at]));
}
