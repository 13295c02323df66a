// The truth for directional occlusion and cone shadows in volumes: many rays through each cone
// (Campagnolo 2021, equations 3-6 and 3-7), from every sample of every ray of the picture. Each
// dispatch adds a few rays a sample to the sum, for a piece of the picture's rays; `finish` takes
// the mean.

//#include "../passes/volume/march.wgsl"
//#include "../passes/volume/lit.wgsl"

struct Truth {
    // sine of the cones' half-angle: occlusion, shadow
    sines: vec2f,
    // cones' lengths in scene units
    reaches: vec2f,
    // rays a cone in this dispatch, before it, and in all
    rays: u32,
    first: u32,
    total: u32,
    // which piece of the rays, and whether this is its last dispatch
    piece: u32,
    last: u32,
    seed: u32,
    // distance of the first sample and between samples, scene units
    gap: f32,
    step: f32,
}

@group(2) @binding(4) var<uniform> truth: Truth;
@group(2) @binding(5) var<storage, read_write> sums: array<vec4f>;
@group(2) @binding(6) var volume_color: texture_storage_2d<rgba16float, write>;
@group(2) @binding(7) var volume_depth: texture_storage_2d<r32float, write>;

// 1 where the scene's surfaces fill space
@group(2) @binding(8) var solids: texture_3d<f32>; // filterable

override OCCLUSION: bool = false;
override HAS_SOLIDS: bool = false;
override SHADOWS: bool = false;

// as the pyramid's: an opacity of one would be an infinite extinction
const MOST_SOLID: f32 = 0.999;

// PCG hash (Jarzynski and Olano 2020) in three dimensions.
fn hash3(at: vec3u) -> vec3u {
    var v = at * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> vec3u(16u);
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    return v;
}

fn frame_around(axis: vec3f) -> mat2x3f {
    let s = select(-1.0, 1.0, axis.z >= 0.0);
    let a = -1.0 / (s + axis.z);
    let b = axis.x * axis.y * a;
    return mat2x3f(
        vec3f(1.0 + s * axis.x * axis.x * a, s * b, -s * axis.x),
        vec3f(b, s + axis.y * axis.y * a, -axis.y),
    );
}

// Equation 3-7: the trapezoid rule along a ray, over the data itself.
fn transmittance(p: vec3f, direction: vec3f, reach: f32) -> f32 {
    let ray = Ray(p, direction);
    let span = crossing(ray);
    let end = min(span.far, reach);
    let origin = texture_position(p);
    let along = texture_direction(direction);
    let inverse = 1.0 / select(along * volume.size, vec3f(1e-20), abs(along) < vec3f(1e-20));
    let scale = truth.step / volume.voxel;
    var depth = 0.0;
    var last = 0.0;
    var k = 0.0;
    for (var t = truth.gap; t < end && depth < 9.0; t = truth.gap + k * truth.step) {
        let uvw = origin + t * along;
        var now = color_at(table_index(value_at(uvw))).w;
        if (HAS_SOLIDS) {
            let solid = textureSampleLevel(solids, trilinear, uvw, 0.0).r;
            now = max(now, -log(1.0 - min(solid, MOST_SOLID)));
        }
        depth += select(0.5, 0.0, k == 0.0) * (last + now) * scale;
        last = now;
        var leap = 0.0;
        if (!HAS_SOLIDS) { // which fill blocks that are empty of the volume's own matter
            leap = empty_length(uvw * volume.size, inverse);
        }
        // the trapezoids at both ends of a leap need the clear samples next to it
        k += max(1.0, floor(leap / truth.step));
    }
    return exp(-depth);
}

// A direction in a cone, with a density proportional to its cosine with the axis: the plain mean
// over such directions is equation 3-6.
fn in_cone(axis: vec3f, sine: f32, random: vec2f) -> vec3f {
    let r = sine * sqrt(random.x);
    let angle = 6.2831853 * random.y;
    return frame_around(axis) * (r * vec2f(cos(angle), sin(angle))) + axis * sqrt(1.0 - r * r);
}

fn light_at(point: Point) -> vec3f {
    if (!is_due(point)) {
        return lit(point, latest.x, latest.yzw);
    }
    var to_eye = -point.direction;
    var open = select(1.0, 0.0, OCCLUSION);
    var shadow = vec3f(1.0);
    let pixel = (point.pixel.y << 16u) + point.pixel.x;
    for (var kind = 0u; kind < 1u + LIGHT_COUNT + (kind >> 31u); kind++) {
        var axis = to_eye;
        var sine = truth.sines.x;
        var reach = truth.reaches.x;
        var layer = -1;
        if (kind > 0u) {
            let arriving = incoming_light(lights.list[kind - 1u], point.position);
            axis = arriving.direction;
            layer = lights.list[kind - 1u].shadow;
            sine = truth.sines.y;
            reach = min(truth.reaches.y, arriving.distance);
        }
        let wanted = select(SHADOWS && layer >= 0 && layer < 3, OCCLUSION, kind == 0u);
        var sum = 0.0;
        for (var i = 0u; wanted && i < truth.rays + (i >> 31u); i++) {
            let n = (truth.first + i) * 4u + kind;
            let bits = hash3(vec3u(pixel, bitcast<u32>(point.t), n * 7919u + truth.seed));
            let random = vec2f(bits.xy >> vec2u(8u)) / 16777216.0;
            sum += transmittance(point.position, in_cone(axis, sine, random), reach);
        }
        let mean = sum / f32(truth.rays);
        if (wanted && kind == 0u) {
            open = mean;
        } else if (wanted) {
            shadow[layer] = mean;
        }
    }
    latest = vec4f(open, shadow);
    return lit(point, open, shadow);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= march.width || id.y >= march.height) {
        return;
    }
    let at = 2u * (id.y * march.width + id.x);
    // what is left through, the next sample's number, distance of half the opacity
    var state = vec3f(1.0, 0.0, 0.0);
    if (truth.piece > 0u) {
        state = sums[at + 1u].xyz;
    }
    if (state.y >= ENDED) {
        return;
    }
    piece = state.xy;
    let result = integrate(id.xy);
    if (truth.first == 0u && truth.piece == 0u) {
        sums[at] = vec4f(0.0);
    }
    sums[at] += f32(truth.rays) * vec4f(result.color.rgb, 0.0);
    if (truth.last != 0u) {
        if (ISOSURFACE) { // has a single sample
            piece = vec2f(1.0 - result.color.a, ENDED);
        }
        sums[at + 1u] = vec4f(piece, max(state.z, result.t), 0.0);
    }
}

@compute @workgroup_size(8, 8)
fn finish(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= march.width || id.y >= march.height) {
        return;
    }
    let at = 2u * (id.y * march.width + id.x);
    let state = sums[at + 1u];
    textureStore(volume_color, id.xy, whole(sums[at].rgb / f32(truth.total), state.x));
    let forward = -view_ray(vec2f(id.xy) + 0.5).direction.z;
    textureStore(volume_depth, id.xy, vec4f(state.z * forward));
}
