// Hybrid occlusion: the closed form's detail times the smoothed ratio between traced visibility
// and the closed form, at half resolution (see hybrid.py).

//#include "view.wgsl"
//#include "tiles.wgsl"
//#include "scene.wgsl"

struct Hybrid {
    reach: u32,
    // which pixel of each 2 x 2 block stands for it
    offset: u32,
    // distances from the tangent plane, in typical radii, at which weights fall to 1/e
    tolerance: f32,
    strength: f32,
}

@group(2) @binding(0) var<uniform> hybrid: Hybrid;
@group(2) @binding(1) var surface: texture_2d<f32>;
// closed form, full resolution
@group(2) @binding(2) var near_field: texture_2d<f32>;
// traced visibility, half resolution
@group(2) @binding(3) var far_field: texture_2d<f32>;
// traced visibility and closed form, smoothed along one axis, then both
@group(2) @binding(4) var pairs: texture_2d<f32>;
@group(2) @binding(5) var smoothed: texture_storage_2d<rg32float, write>;
@group(2) @binding(6) var result: texture_storage_2d<r32float, write>;

struct Center {
    position: vec3f,
    normal: vec3f,
    sharpness: f32,
}

fn full_pixel(half: vec2i) -> vec2i {
    let offset = vec2i(vec2u(hybrid.offset & 1u, hybrid.offset >> 1u));
    return min(half * 2 + offset, vec2i(textureDimensions(surface)) - 1);
}

fn view_normal(n: vec3f) -> vec3f {
    return (view.view_from_scene * vec4f(n, 0.0)).xyz;
}

fn center_of(pixel: vec2i, texel: vec4f) -> Center {
    let span = 2.0 * f32(hybrid.reach) * pixel_width(texel.w);
    return Center(
        view_position(vec2f(pixel) + 0.5, texel.w),
        view_normal(texel.xyz),
        1.0 / (hybrid.tolerance * scene.primitive_radius + 0.5 * span),
    );
}

fn weight(center: Center, pixel: vec2i, texel: vec4f) -> f32 {
    let apart = view_position(vec2f(pixel) + 0.5, texel.w) - center.position;
    let off = dot(center.normal, apart) * center.sharpness;
    let turn = max(dot(center.normal, view_normal(texel.xyz)), 0.0);
    return select(0.0, exp(-off * off) * turn * turn, texel.w > 0.0);
}

fn inside(half: vec2i) -> bool {
    return all(half >= vec2i(0)) && all(half < vec2i(textureDimensions(far_field)));
}

fn pair_at(half: vec2i, vertical: bool) -> vec2f {
    if (vertical) {
        return textureLoad(pairs, half, 0).xy;
    }
    return vec2f(
        textureLoad(far_field, half, 0).x, textureLoad(near_field, full_pixel(half), 0).x,
    );
}

fn along(half: vec2i, axis: vec2i, vertical: bool) -> vec2f {
    let pixel = full_pixel(half);
    let center = center_of(pixel, textureLoad(surface, pixel, 0));
    let reach = i32(hybrid.reach);
    var sum = pair_at(half, vertical);
    var total = 1.0;
    for (var i = -reach; i <= reach; i += 1) {
        let place = half + i * axis;
        if (i == 0 || !inside(place)) {
            continue;
        }
        let there = full_pixel(place);
        let x = f32(i) / (f32(reach) + 0.5);
        let w = weight(center, there, textureLoad(surface, there, 0)) * (1.0 - x * x);
        sum += w * pair_at(place, vertical);
        total += w;
    }
    return sum / total;
}

fn half_place(group: vec3u, local: vec3u) -> vec2i {
    return vec2i(tile_pixel(group, vec3u(0u)) / 2u + local.xy);
}

@compute @workgroup_size(4, 4)
fn across(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let half = half_place(group, local);
    if (inside(half)) {
        textureStore(smoothed, half, vec4f(along(half, vec2i(1, 0), false), 0.0, 0.0));
    }
}

@compute @workgroup_size(4, 4)
fn down(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let half = half_place(group, local);
    if (inside(half)) {
        textureStore(smoothed, half, vec4f(along(half, vec2i(0, 1), true), 0.0, 0.0));
    }
}

@compute @workgroup_size(8, 8)
fn combine(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = vec2i(tile_pixel(group, local));
    if (any(pixel >= vec2i(textureDimensions(surface)))) {
        return;
    }
    let texel = textureLoad(surface, pixel, 0);
    if (texel.w <= 0.0) {
        textureStore(result, pixel, vec4f(1.0));
        return;
    }
    let center = center_of(pixel, texel);
    let offset = vec2i(vec2u(hybrid.offset & 1u, hybrid.offset >> 1u));
    let base = (pixel - offset) / 2 - select(vec2i(0), vec2i(1), pixel < offset);
    var sum = vec2f(0.0);
    for (var y = 0; y <= 1; y += 1) {
        for (var x = 0; x <= 1; x += 1) {
            let half = clamp(base + vec2i(x, y), vec2i(0), vec2i(textureDimensions(pairs)) - 1);
            let place = full_pixel(half);
            let near = max(vec2f(0.1), 1.0 - 0.5 * abs(vec2f(pixel - place)));
            // never nothing: the pixel's own block is better than no answer
            let w = near.x * near.y * weight(center, place, textureLoad(surface, place, 0)) + 1e-5;
            sum += w * textureLoad(pairs, half, 0).xy;
        }
    }
    let ratio = sum.x / max(sum.y, 1e-3);
    let open = saturate(textureLoad(near_field, pixel, 0).x * ratio);
    textureStore(result, pixel, vec4f(pow(open, hybrid.strength)));
}
