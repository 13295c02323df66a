// Edge-aware smoothing: weights fall with the distance from the pixel's tangent plane and with the
// angle between normals, so that neither silhouettes nor creases are blurred.

//#include "view.wgsl"
//#include "tiles.wgsl"
//#include "scene.wgsl"

struct Smooth {
    // radius of the kernel, or step between taps (atrous), in pixels
    reach: u32,
    // which pixel of each 2 x 2 block a half-resolution texel stands for
    offset: u32,
}

@group(2) @binding(0) var<uniform> smooth_settings: Smooth;
@group(2) @binding(1) var surface: texture_2d<f32>;
@group(2) @binding(2) var source: texture_2d<f32>;
@group(2) @binding(3) var result: texture_storage_2d<r32float, write>;

struct Center {
    pixel: vec2i,
    position: vec3f,
    normal: vec3f,
    // one over the distance from the tangent plane at which the weight is 1/e
    sharpness: f32,
}

fn position_at(pixel: vec2i, depth: f32) -> vec3f {
    return view_position(vec2f(pixel) + 0.5, depth);
}

fn center_at(pixel: vec2i, texel: vec4f, reach: f32) -> Center {
    // a sphere of the typical radius falls off its tangent plane by x^2 / 2r at a distance x: what
    // the kernel spans of one atom is kept together, what lies on another is not
    let span = reach * pixel_width(texel.w);
    let tolerance = 0.1 * scene.primitive_radius + 0.5 * span;
    return Center(pixel, position_at(pixel, texel.w),
        (view.view_from_scene * vec4f(texel.xyz, 0.0)).xyz, 1.0 / tolerance);
}

fn weight(center: Center, pixel: vec2i, texel: vec4f) -> f32 {
    let off = dot(center.normal, position_at(pixel, texel.w) - center.position) * center.sharpness;
    let normal = (view.view_from_scene * vec4f(texel.xyz, 0.0)).xyz;
    let turn = max(dot(center.normal, normal), 0.0);
    return select(0.0, exp(-off * off) * turn * turn * turn * turn, texel.w > 0.0);
}

fn inside(pixel: vec2i) -> bool {
    return all(pixel >= vec2i(0)) && all(pixel < vec2i(textureDimensions(surface)));
}

// Negative values are unknown: they stay so, and do not count for others.
fn along(pixel: vec2i, axis: vec2i) -> f32 {
    let texel = textureLoad(surface, pixel, 0);
    let reach = i32(smooth_settings.reach);
    let center = center_at(pixel, texel, f32(reach));
    var sum = textureLoad(source, pixel, 0).x;
    var total = 1.0;
    // a flat top as wide as the pattern of ray directions, then a soft end
    for (var i = -reach; i <= reach; i += 1) {
        let place = pixel + i * axis;
        if (i == 0 || !inside(place)) {
            continue;
        }
        let here = textureLoad(surface, place, 0);
        let x = f32(i) / (f32(reach) + 0.5);
        let value = textureLoad(source, place, 0).x;
        let w = select(weight(center, place, here) * (1.0 - x * x), 0.0, value < 0.0);
        sum += w * value;
        total += w;
    }
    return select(sum / total, -1.0, textureLoad(source, pixel, 0).x < 0.0);
}

@compute @workgroup_size(8, 8)
fn across(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = vec2i(tile_pixel(group, local));
    if (inside(pixel)) {
        textureStore(result, pixel, vec4f(along(pixel, vec2i(1, 0))));
    }
}

@compute @workgroup_size(8, 8)
fn down(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = vec2i(tile_pixel(group, local));
    if (inside(pixel)) {
        let value = along(pixel, vec2i(0, 1));
        textureStore(result, pixel, vec4f(select(value, 1.0, value < 0.0)));
    }
}

// One level of the a-trous wavelet transform: a 5 x 5 B3 spline with holes.
@compute @workgroup_size(8, 8)
fn atrous(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = vec2i(tile_pixel(group, local));
    if (!inside(pixel)) {
        return;
    }
    let step = i32(smooth_settings.reach);
    let center = center_at(pixel, textureLoad(surface, pixel, 0), 2.0 * f32(step));
    var sum = 0.0;
    var total = 0.0;
    for (var y = -2; y <= 2; y += 1) {
        for (var x = -2; x <= 2; x += 1) {
            let place = pixel + step * vec2i(x, y);
            if (!inside(place)) {
                continue;
            }
            let spline = exp2(-f32(abs(x) + abs(y)) * select(1.0, 1.3, abs(x) + abs(y) > 1));
            let itself = x == 0 && y == 0;
            let w = spline * select(weight(center, place, textureLoad(surface, place, 0)), 1.0, itself);
            sum += w * textureLoad(source, place, 0).x;
            total += w;
        }
    }
    textureStore(result, pixel, vec4f(sum / total));
}

// Joint bilateral upsampling (Kopf et al. 2007) from one real pixel of each 2 x 2 block.
@compute @workgroup_size(8, 8)
fn upsample(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = vec2i(tile_pixel(group, local));
    if (!inside(pixel)) {
        return;
    }
    let offset = vec2i(vec2u(smooth_settings.offset & 1u, smooth_settings.offset >> 1u));
    let size = vec2i(textureDimensions(source));
    let limit = vec2i(textureDimensions(surface)) - 1;
    let center = center_at(pixel, textureLoad(surface, pixel, 0), 2.0);
    let base = (pixel - offset) / 2 - select(vec2i(0), vec2i(1), pixel < offset);
    var sum = 0.0;
    var total = 0.0;
    var nearest = 1.0;
    var best = -1.0;
    for (var y = 0; y <= 1; y += 1) {
        for (var x = 0; x <= 1; x += 1) {
            let texel = clamp(base + vec2i(x, y), vec2i(0), size - 1);
            let place = min(texel * 2 + offset, limit);
            let near = max(vec2f(0.1), 1.0 - 0.5 * abs(vec2f(pixel - place)));
            let w = near.x * near.y * weight(center, place, textureLoad(surface, place, 0));
            let value = textureLoad(source, texel, 0).x;
            sum += w * value;
            total += w;
            if (w > best) {
                best = w;
                nearest = value;
            }
        }
    }
    textureStore(result, pixel, vec4f(select(nearest, sum / total, total > 1e-4)));
}
