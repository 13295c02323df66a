// A path tracer over the scene's one tracer: next-event estimation for every light, an environment
// that paths see when they leave, Russian roulette. One dispatch adds one sample to each pixel.

//#include "view.wgsl"
//#include "tiles.wgsl"
//#include "surface.wgsl"
//#include "color.wgsl"
//#include "light_samples.wgsl"
//#include "sobol.wgsl"
//#include "materials.wgsl"
//#include "glass.wgsl"

struct Paths {
    size: vec2u,
    // which sample of each pixel this is
    index: u32,
    // how often a path may scatter
    bounces: u32,
    // tangent of the angular radius of lights without a size
    spread: f32,
    // contributions are cut to this
    limit: f32,
    // how much brighter the environment is above than in the middle, 0 for a constant one
    gradient: f32,
    // whether samples are spread over the pixel
    antialias: u32,
}

@group(2) @binding(0) var<uniform> paths: Paths;
@group(2) @binding(1) var<uniform> lights: Lights;
// sums of (linear RGB, coverage), a row after the other
@group(2) @binding(2) var<storage, read_write> sums: array<vec4f>;
@group(2) @binding(3) var color: texture_storage_2d<rgba16float, write>;

// sRGB, one an object; alpha 0 leaves an object's own colors
@group(2) @binding(4) var<storage, read> object_colors: array<u32>;

override RECOLORED: bool = false;

const ROULETTE_FROM: u32 = 3u;

fn environment(direction: vec3f) -> vec3f {
    let up = view.scene_from_view[1].xyz;
    return lights.ambient * (1.0 + paths.gradient * dot(direction, up));
}

// Light that reaches a point directly and leaves it towards the viewer.
fn direct_light(
    at: Surface, frame: mat3x3f, origin: vec3f, outgoing: vec3f, material: Material, albedo: vec3f,
    pair: u32, seed: u32,
) -> vec3f {
    var sum = vec3f(0.0);
    for (var i = 0u; i < LIGHT_COUNT; i += 1u) {
        let light = lights.list[i];
        let arriving = incoming_light(light, at.position);
        let u = sobol_point(paths.index, pair + i, seed);
        // a disc gives a surface that faces its middle the light's strength, whatever its size
        let direction = light_direction(light, arriving, paths.spread, u);
        let share = reflected(material, albedo, outgoing, transpose(frame) * direction)
            * arriving.color / dot(direction, arriving.direction);
        let casts = light.shadow >= 0 && any(share > vec3f(0.0));
        let end = select(-1.0, arriving.distance, casts);
        sum += select(share, vec3f(0.0), trace_any(Ray(origin, direction), 0.0, end));
    }
    return sum;
}

fn added(throughput: vec3f, light: vec3f) -> vec3f {
    return min(throughput * light, vec3f(paths.limit));
}

// Radiance along a ray, and whether it met anything.
fn path_light(first: Ray, seed: u32) -> vec4f {
    var ray = first;
    var throughput = vec3f(1.0);
    var sum = vec3f(0.0);
    var met = 0.0;
    var inside = OUTSIDE;
    for (var bounce = 0u; bounce <= paths.bounces + (bounce >> 31u); bounce += 1u) {
        // two pairs for the way on, one for each light; the first is the place in the pixel
        let pair = 1u + bounce * (2u + LIGHT_COUNT);
        let u = sobol_point(paths.index, pair, seed);
        let choice = sobol_point(paths.index, pair + 1u, seed);
        if (HAS_GLASS && inside.primitive != NO_PRIMITIVE) {
            let left = leave_glass(ray, inside, choice.x);
            ray = left.ray;
            inside = left.inside;
            throughput *= left.weight;
            if (!left.opaque) {
                continue;
            }
        }
        let hit = trace_nearest(ray, 0.0, NOTHING);
        if (hit.primitive == NO_PRIMITIVE) {
            sum += select(added(throughput, environment(ray.direction)), vec3f(0.0), met == 0.0);
            break;
        }
        met = 1.0;
        if (bounce == paths.bounces + (bounce >> 31u)) {
            break;
        }
        var at = surface_at(ray, hit);
        if (RECOLORED) {
            let given = unpack4x8unorm(object_colors[at.object]);
            at.color = select(at.color, linear_from_srgb(given.rgb), given.a > 0.0);
        }
        let material = material_at(at.object);
        let albedo = at.color * material.diffuse;
        let depth = length(at.position - first.origin);
        let offset = at.normal * surface_offset(at.position, depth);
        if (HAS_GLASS && material.kind == GLASS) {
            let entered = enter_glass(ray, hit, at, material, choice.x);
            ray = entered.ray;
            inside = entered.inside;
            throughput *= select(vec3f(1.0), at.color, inside.primitive != NO_PRIMITIVE);
            continue;
        }
        let frame = tangent_frame(at.normal);
        let outgoing = transpose(frame) * -ray.direction;
        let origin = at.position + offset;
        sum += added(throughput, direct_light(at, frame, origin, outgoing, material, albedo,
            pair + 2u, seed));
        let next = scatter(material, albedo, outgoing, u, choice.x);
        throughput *= next.weight;
        let brightest = max(throughput.x, max(throughput.y, throughput.z));
        let survival = select(1.0, min(brightest, 0.95), bounce >= ROULETTE_FROM);
        if (brightest <= 0.0 || choice.y >= survival) {
            break;
        }
        throughput /= survival;
        ray = Ray(origin, frame * next.direction);
    }
    return vec4f(sum, met);
}

@compute @workgroup_size(8, 8)
fn add(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = tile_pixel(group, in_blocks(local));
    if (any(pixel >= paths.size)) {
        return;
    }
    let place = pixel + vec2u(view.origin);
    let seed = hash(place.x + hash(place.y + hash(view.seed)));
    ray_chance = hash(seed + paths.index);
    let within = select(vec2f(0.5), sobol_point(paths.index, 0u, seed), paths.antialias != 0u);
    let light = path_light(scene_ray(vec2f(pixel) + within), seed);
    let row = pixel.x + pixel.y * paths.size.x;
    // the first sample replaces what an earlier picture left
    sums[row] = select(sums[row], vec4f(0.0), paths.index == 0u) + light;
}

// Means of the sums; `index` is then the number of samples.
@compute @workgroup_size(8, 8)
fn mean(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = tile_pixel(group, local);
    if (all(pixel < paths.size)) {
        textureStore(color, pixel, sums[pixel.x + pixel.y * paths.size.x] / f32(paths.index));
    }
}
