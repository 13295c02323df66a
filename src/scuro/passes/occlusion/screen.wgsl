// Screen-space occlusion: what the depth buffer tells of a point's surroundings.
//
//   ssao   points in the hemisphere about the normal, against the depth behind their pixel
//   hbao   horizons along lines through the pixel, above the tangent plane (Bavoil et al. 2008)
//   gtao   horizons, cosine-weighted exactly between them (Jimenez et al. 2016)
//
// Nothing is known beyond the picture and behind what is seen: both count as open.

//#include "view.wgsl"
//#include "reach.wgsl"
//#include "tiles.wgsl"
//#include "scene.wgsl"
//#include "sampling.wgsl"

struct Screen {
    // points, or lines times steps
    samples: u32,
    lines: u32,
    // of the surroundings, and least height of an occluder, in scene units
    radius: f32,
    bias: f32,
    // sine of the angle over the tangent plane from which occluders count (hbao)
    angle_bias: f32,
    // which pixel of each 2 x 2 block stands for it, at half resolution
    offset: u32,
    // how far is looked in the picture, pixels
    limit: f32,
}

@group(2) @binding(0) var<uniform> screen: Screen;
@group(2) @binding(1) var surface: texture_2d<f32>;
// points of the unit sphere for each of 4 x 4 interleaved pixel classes
@group(2) @binding(2) var directions: texture_2d<f32>;
@group(2) @binding(3) var result: texture_storage_2d<r32float, write>;

// 0 ssao, 1 hbao, 2 gtao
override KIND: u32 = 0u;

const PATTERN: u32 = 4u;

struct Point {
    pixel: vec2f,
    position: vec3f,
    normal: vec3f,
    // of the 16 classes, and the same scattered over [0, 1)
    class_index: u32,
    turn: f32,
}

// Depth at a pixel; 0 where there is nothing, or nothing is known.
fn depth_at(pixel: vec2f) -> f32 {
    let size = vec2f(textureDimensions(surface));
    let inside = all(pixel >= vec2f(0.0)) && all(pixel < size);
    let place = vec2u(clamp(pixel, vec2f(0.0), size - 1.0));
    return select(0.0, textureLoad(surface, place, 0).w, inside);
}

fn ssao(p: Point) -> f32 {
    var blocked = 0.0;
    let radius = radius_within(screen.radius, p.position, screen.limit);
    for (var i = 0u; i < screen.samples; i += 1u) {
        let index = p.class_index * screen.samples + i;
        let around = textureLoad(directions, table_place(index), 0).xyz;
        let direction = cosine_direction(p.normal, (view.view_from_scene * vec4f(around, 0.0)).xyz);
        // more points near by, where occluders block most
        let share = (f32(i) + 0.5) / f32(screen.samples);
        let reach = radius * mix(0.05, 1.0, share * share);
        let there = pixel_from_view(p.position + reach * direction);
        let depth = depth_at(there.xy);
        let gap = there.z - depth;
        let near = smoothstep(0.0, 1.0, screen.radius / max(abs(-p.position.z - depth), 1e-6));
        blocked += select(0.0, near, depth > 0.0 && gap > screen.bias);
    }
    return 1.0 - blocked / f32(screen.samples);
}

struct Horizon {
    // cosine between the eye's direction and the horizon
    cosine: f32,
    // share blocked along this half line (hbao)
    blocked: f32,
}

// The highest horizon along a half line of the picture, from `low` up.
fn horizon(p: Point, step: vec2f, steps: u32, to_eye: vec3f, low: f32) -> Horizon {
    var found = Horizon(low, 0.0);
    var top = screen.angle_bias;
    for (var i = 0u; i < steps; i += 1u) {
        let share = (f32(i) + 0.25 + 0.75 * fract(p.turn * 7.0)) / f32(steps);
        let at = floor(p.pixel + step * share * share + 0.5 * sign(step)) + 0.5;
        let depth = depth_at(at);
        let apart = view_position(at, depth) - p.position;
        let range = length(apart);
        let falloff = saturate(2.0 - 2.0 * range / screen.radius);
        let counts = depth > 0.0 && range > screen.bias;
        let direction = apart / max(range, 1e-9);
        let seen = mix(low, dot(direction, to_eye), falloff);
        found.cosine = max(found.cosine, select(low, seen, counts));
        let height = dot(direction, p.normal);
        let rise = select(0.0, max(height - top, 0.0), counts);
        found.blocked += falloff * rise;
        top += rise;
    }
    return found;
}

fn horizons(p: Point) -> f32 {
    var to_eye = -normalize(p.position);
    if (view.orthographic != 0u) {
        to_eye = vec3f(0.0, 0.0, 1.0);
    }
    let steps = max(1u, screen.samples / (2u * screen.lines));
    let reach = min(screen.radius / pixel_width(-p.position.z), screen.limit);
    var sum = 0.0;
    for (var i = 0u; i < screen.lines; i += 1u) {
        let angle = PI * (f32(i) + p.turn) / f32(screen.lines);
        let line = vec3f(cos(angle), sin(angle), 0.0);
        // the picture's y points down
        let step = vec2f(line.x, -line.y) * reach;
        if (KIND == 1u) {
            let ahead = horizon(p, step, steps, to_eye, -1.0);
            let behind = horizon(p, -step, steps, to_eye, -1.0);
            sum += 1.0 - 0.5 * (ahead.blocked + behind.blocked);
            continue;
        }
        let across = line - dot(line, to_eye) * to_eye;
        let axis = normalize(cross(across, to_eye));
        let flat_normal = p.normal - axis * dot(p.normal, axis);
        let size = max(length(flat_normal), 1e-6);
        let cosine = saturate(dot(flat_normal, to_eye) / size);
        let tilt = sign(dot(across, flat_normal)) * acos(cosine);
        let one = horizon(p, step, steps, to_eye, cos(tilt + 0.5 * PI)).cosine;
        let other = horizon(p, -step, steps, to_eye, cos(tilt - 0.5 * PI)).cosine;
        let ahead = acos(clamp(one, -1.0, 1.0));
        let behind = -acos(clamp(other, -1.0, 1.0));
        let arcs = 2.0 * cosine + 2.0 * (ahead + behind) * sin(tilt)
            - cos(2.0 * ahead - tilt) - cos(2.0 * behind - tilt);
        sum += size * 0.25 * arcs;
    }
    return sum / f32(screen.lines);
}

fn visibility_at(pixel: vec2u, place: vec2u) -> f32 {
    let texel = textureLoad(surface, pixel, 0);
    if (texel.w <= 0.0) {
        return 1.0;
    }
    let center = vec2f(pixel) + 0.5;
    let class_index = place.x % PATTERN + PATTERN * (place.y % PATTERN);
    // neighbouring classes get turns far apart
    let turn = fract(f32(class_index) * 0.6180339887 + f32(view.frame) * 0.7548776662);
    let p = Point(
        center,
        view_position(center, texel.w),
        (view.view_from_scene * vec4f(texel.xyz, 0.0)).xyz,
        class_index,
        turn,
    );
    var open = 0.0;
    if (KIND == 0u) {
        open = ssao(p);
    } else {
        open = horizons(p);
    }
    return saturate(open);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = tile_pixel(group, local);
    if (all(pixel < textureDimensions(result))) {
        textureStore(result, pixel, vec4f(visibility_at(pixel, pixel + vec2u(view.origin))));
    }
}

@compute @workgroup_size(4, 4)
fn half(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let place = tile_pixel(group, vec3u(0u)) / 2u + local.xy;
    if (any(place >= textureDimensions(result))) {
        return;
    }
    let pixel = min(place * 2u + vec2u(screen.offset & 1u, screen.offset >> 1u),
        textureDimensions(surface) - 1u);
    textureStore(result, place, vec4f(visibility_at(pixel, place + vec2u(view.origin) / 2u)));
}
