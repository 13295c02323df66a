// The picture's rays through a volume: where they start, where surfaces stop them, and what a sample
// of one is to lighting.

//#include "view.wgsl"
//#include "volume.wgsl"

struct March {
    // rays end where they let less light through than this
    cutoff: f32,
    // share of a step by which starts are shifted at random
    jitter: f32,
    // value of the isosurface, normalised; its color and opacity come from the tables
    iso: f32,
    // width and height of the picture
    width: u32,
    height: u32,
    // pixels of `surface` for one of the picture
    surface_scale: vec2f,
}

@group(2) @binding(0) var<uniform> march: March;
// scene normal and depth (-z in view space; 0 where empty) of the surfaces that stop rays
@group(2) @binding(1) var surface: texture_2d<f32>;

override ISOSURFACE: bool = false;
override SURFACES: bool = false;

// A sample of a ray, as lighting sees it.
struct Point {
    // scene and texture coordinates
    position: vec3f,
    uvw: vec3f,
    // of the ray
    direction: vec3f,
    t: f32,
    // share of the picture that it contributes
    weight: f32,
    // of the cut face that it lies on, else 0
    cut_normal: vec3f,
    pixel: vec2u,
}

// Blue enough: Jimenez' interleaved gradient noise, shifted each frame by the golden ratio.
fn start_shift(pixel: vec2u) -> f32 {
    let at = vec2f(pixel) + view.origin;
    let noise = fract(52.9829189 * fract(dot(at, vec2f(0.06711056, 0.00583715))));
    return fract(noise + 0.61803399 * f32(view.frame)) * march.jitter;
}

// Farthest a pixel's ray may go before a surface stops it.
fn surface_limit(pixel: vec2u) -> f32 {
    if (!SURFACES) {
        return NOTHING;
    }
    let at = (vec2f(pixel) + 0.5) * march.surface_scale;
    let depth = textureLoad(surface, vec2u(at), 0).w;
    return select(ray_distance(vec2f(pixel) + 0.5, depth), NOTHING, depth <= 0.0);
}

// Where light precomputed in so many texels is read for a sample: on a cut face one texel before it,
// or texels inside the matter would show in it as stripes.
fn light_place(point: Point, texels: vec3f) -> vec3f {
    let outward = texture_direction(point.cut_normal);
    return point.uvw + outward / max(length(outward * texels), 1e-12);
}

// Light is worked out anew when so much of the picture has been added since the last time: samples
// that matter little are not worth a cone each, but many of them are.
const LEAST_WEIGHT: f32 = 0.001;
var<private> pending: f32 = LEAST_WEIGHT;
var<private> latest: vec4f = vec4f(1.0);

fn is_due(point: Point) -> bool {
    pending += point.weight;
    let due = pending >= LEAST_WEIGHT;
    pending = select(pending, 0.0, due);
    return due;
}
