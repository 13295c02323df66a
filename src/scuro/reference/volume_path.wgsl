// Multiple scattering in a volume by delta tracking (Woodcock et al. 1965). Each dispatch adds a few
// paths a pixel to the sums; `finish` takes the mean.

//#include "../passes/volume/rays.wgsl"
//#include "../passes/volume/lamps.wgsl"
//#include "sampling.wgsl"

struct Paths {
    // no extinction is larger, per scene unit
    majorant: f32,
    // mean cosine of the scattering angle (Henyey and Greenstein 1941)
    anisotropy: f32,
    // how often a path may scatter
    bounces: u32,
    // how much brighter the environment is above than in the middle
    gradient: f32,
    // paths a pixel before this dispatch, in it, and in all
    first: u32,
    count: u32,
    total: u32,
}

@group(2) @binding(4) var<uniform> paths: Paths;
// for each pixel: linear color and opacity; depth, and how many paths met something
@group(2) @binding(5) var<storage, read_write> sums: array<vec4f>;
@group(2) @binding(6) var volume_color: texture_storage_2d<rgba16float, write>;
@group(2) @binding(7) var volume_depth: texture_storage_2d<r32float, write>;

const ROULETTE_FROM: u32 = 8u;

var<private> state: u32;

fn random() -> f32 {
    state = hash(state);
    return unit_float(state);
}

// Distance along a ray to the next collision, or NOTHING when it gets beyond `limit`.
fn free_path(ray: Ray, limit: f32) -> f32 {
    let span = crossing(ray);
    let end = min(span.far, limit);
    let origin = texture_position(ray.origin);
    let direction = texture_direction(ray.direction);
    let inverse = 1.0 / select(direction * volume.size, vec3f(1e-20), abs(direction) < vec3f(1e-20));
    var t = span.near;
    for (; t < end;) {
        // paths have no memory: they may leap over empty space before they draw a length
        t += empty_length((origin + t * direction) * volume.size, inverse);
        t -= log(1.0 - random()) / paths.majorant;
        if (t < end
            && random() * paths.majorant * volume.voxel < extinction_at(origin + t * direction)) {
            return t;
        }
    }
    return NOTHING;
}

fn environment(direction: vec3f) -> vec3f {
    return lights.ambient * (1.0 + paths.gradient * dot(direction, view.scene_from_view[1].xyz));
}

fn phase(cosine: f32) -> f32 {
    let g = paths.anisotropy;
    let d = max(1.0 + g * g - 2.0 * g * cosine, 1e-6);
    return (1.0 - g * g) / (4.0 * PI * d * sqrt(d));
}

// A direction with the density of the phase function, by its inverse distribution.
fn scattered(along: vec3f) -> vec3f {
    let g = paths.anisotropy;
    let u = random();
    var cosine = 1.0 - 2.0 * u;
    if (abs(g) > 1e-3) {
        let s = (1.0 - g * g) / (1.0 - g + 2.0 * g * u);
        cosine = (1.0 + g * g - s * s) / (2.0 * g);
    }
    let ring = sqrt(max(0.0, 1.0 - cosine * cosine));
    let angle = 2.0 * PI * random();
    return normalize(tangent_frame(along) * vec3f(ring * cos(angle), ring * sin(angle), cosine));
}

// Light that comes straight from the lights and is scattered toward `-along`.
fn from_lights(p: vec3f, along: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    for (var i = 0u; i < LIGHT_COUNT; i++) {
        let arriving = incoming_light(lights.list[i], p);
        if (all(arriving.color <= vec3f(0.0))) {
            continue;
        }
        let met = free_path(Ray(p, arriving.direction), arriving.distance);
        let share = PI * phase(dot(arriving.direction, along));
        sum += select(vec3f(0.0), arriving.color * share, met >= NOTHING);
    }
    return sum;
}

struct Path {
    // radiance, and 1 where anything was met
    color: vec4f,
    // distance of the first collision
    t: f32,
}

fn follow(first: Ray, limit: f32) -> Path {
    var ray = first;
    var out = Path(vec4f(0.0), 0.0);
    var through = vec3f(1.0);
    for (var n = 0u; ; n++) {
        let t = free_path(ray, select(NOTHING, limit, n == 0u));
        if (t >= NOTHING) {
            // the picture's background is not the environment: it stays behind the volume
            out.color += vec4f(select(through * environment(ray.direction), vec3f(0.0), n == 0u), 0.0);
            break;
        }
        if (n >= paths.bounces) {
            break;
        }
        if (n == 0u) {
            out.t = t;
            out.color.w = 1.0;
        }
        let p = ray.origin + t * ray.direction;
        var value = value_at(texture_position(p));
        if (ISOSURFACE) {
            value = march.iso;
        }
        through *= color_at(table_index(value)).rgb;
        out.color += vec4f(through * from_lights(p, ray.direction), 0.0);
        if (n >= ROULETTE_FROM) {
            let stay = min(max(through.x, max(through.y, through.z)), 1.0);
            if (random() >= stay) {
                break;
            }
            through /= stay;
        }
        ray = Ray(p, scattered(ray.direction));
    }
    return out;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= march.width || id.y >= march.height) {
        return;
    }
    let at = 2u * (id.y * march.width + id.x);
    let pixel = vec2u(vec2f(id.xy) + view.origin);
    let ray = scene_ray(vec2f(id.xy) + 0.5);
    let limit = surface_limit(id.xy);
    var color = vec4f(0.0);
    var depth = vec2f(0.0);
    for (var i = 0u; i < paths.count; i++) {
        state = hash(pixel.x + hash(pixel.y + hash(paths.first + i + hash(view.seed))));
        let path = follow(ray, limit);
        color += path.color;
        depth += vec2f(path.t, path.color.w);
    }
    let more = paths.first > 0u;
    sums[at] = select(vec4f(0.0), sums[at], more) + color;
    sums[at + 1u] = select(vec4f(0.0), sums[at + 1u], more) + vec4f(depth, 0.0, 0.0);
}

@compute @workgroup_size(8, 8)
fn finish(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= march.width || id.y >= march.height) {
        return;
    }
    let at = 2u * (id.y * march.width + id.x);
    textureStore(volume_color, id.xy, sums[at] / f32(paths.total));
    let depth = sums[at + 1u];
    let forward = -view_ray(vec2f(id.xy) + 0.5).direction.z;
    textureStore(volume_depth, id.xy, vec4f(depth.x / max(depth.y, 1.0) * forward));
}
