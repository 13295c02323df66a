// Edges of far views: where pixels hold many atoms, what stands out (fxaa_edges.wgsl) is smoothed by
// rays. Each goes through another place of the pixel and takes the finished color of that pixel about
// it which shows what it met: geometry is sampled finely, light once a pixel (Chajdas, McGuire & Luebke
// 2011, "Subpixel reconstruction antialiasing"). Near ones are left to FXAA, with a smooth passage.

//#include "view.wgsl"
//#include "surface.wgsl"
//#include "../post/fxaa_smooth.wgsl"

// holds `color`
@group(2) @binding(5) var replaced: texture_storage_2d<rgba16float, write>;
@group(2) @binding(6) var surface: texture_2d<f32>;
@group(2) @binding(7) var ids: texture_2d<u32>;

struct Still {
    // deviation of the spread, pixels, for each atom that a pixel's width holds (still.wgsl)
    spread: f32,
    // most of it, pixels
    most: f32,
    // diameter of an atom, scene units
    atom: f32,
}

@group(2) @binding(8) var<uniform> still: Still;

const RAYS: u32 = 4u;
// Pixels whose width holds half an atom are left to FXAA, those that hold so many more are not.
const PASSAGE: f32 = 0.25;
const NONE: u32 = 0xffffffffu;
// What is less like a ray's hit than this is no part of it.
const STRANGE: f32 = 1e3;

// What a pixel shows; its depth is 0 where it is empty.
struct Shown {
    depth: f32,
    instance: u32,
    object: u32,
}

fn shown_at(pixel: vec2i) -> Shown {
    let found = textureLoad(ids, pixel, 0);
    return Shown(textureLoad(surface, pixel, 0).w, found.y, found.z);
}

// How unlike two things are: objects have colors of their own, instances only shades.
fn unlike(one: Shown, other: Shown, width: f32) -> f32 {
    let apart = abs(one.depth - other.depth) / width;
    return select(0.0, STRANGE, one.object != other.object)
        + select(0.0, 4.0, one.instance != other.instance) + apart / (1.0 + apart);
}

// The mean color of what so many rays meet in a pixel: linear, premultiplied.
fn by_rays(rays: u32, pixel: vec2i, last: vec2i, about: ptr<function, array<Shown, 9>>) -> vec4f {
    var sum = textureLoad(color, pixel, 0);
    var weights = 1.0;
    for (var i = 0u; i < rays; i += 1u) {
        // R2 sequence (Roberts 2018)
        let shift = fract(vec2f(0.7548776662, 0.5698402910) * f32(i + 1u)) - 0.5;
        let place = vec2f(pixel) + 0.5 + shift;
        let ray = scene_ray(place);
        let hit = trace_nearest(ray, 0.0, NOTHING);
        var met = Shown(0.0, NONE, NONE);
        if (hit.primitive != NO_PRIMITIVE) {
            let object = instance_at(hit.instance).object;
            met = Shown(hit.t * -view_ray(place).direction.z, hit_number(hit), object);
        }
        let width = pixel_width(max(met.depth, 1e-6));
        var least = 2.0 * STRANGE;
        var best = 4;
        for (var k = 0; k < 9; k += 1) {
            let away = vec2f(vec2i(k % 3, k / 3) - 1) - shift;
            let score = unlike(met, (*about)[k], width) + 0.1 * dot(away, away);
            if (score < least) {
                least = score;
                best = k;
            }
        }
        // what no pixel about shows has no light: it is passed over
        let weight = select(0.0, 1.0, least < STRANGE);
        let at = clamp(pixel + vec2i(best % 3, best / 3) - 1, vec2i(0), last);
        sum += weight * textureLoad(color, at, 0);
        weights += weight;
    }
    return sum / weights;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let edge = edge_pixel(id.x);
    if (any(edge >= textureDimensions(replaced))) {
        return;
    }
    let pixel = vec2i(edge);
    let last = vec2i(textureDimensions(color)) - 1;
    var about: array<Shown, 9>;
    var nearest_depth = NOTHING;
    for (var k = 0; k < 9; k += 1) {
        about[k] = shown_at(clamp(pixel + vec2i(k % 3, k / 3) - 1, vec2i(0), last));
        let depth = about[k].depth;
        nearest_depth = select(nearest_depth, min(nearest_depth, depth), depth > 0.0);
    }
    let held = select(0.0, pixel_width(nearest_depth) / still.atom - 0.5, nearest_depth < NOTHING);
    let share = smoothstep(0.0, PASSAGE, held);
    // a loop that ends at once is left; a branch would be run all the same
    let far = by_rays(select(0u, RAYS, share > 0.0), pixel, last, &about);
    textureStore(replaced, edge, mix(smoothed(edge), far, share));
}
