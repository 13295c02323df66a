// Pass 3: screen-space directional occlusion between regions (Algorithm 2) with one bounce of
// indirect light (equation 3.2).
//
// Two reaches: the near one tells atoms apart and fades out as the camera goes away; the far one
// counts occluders of another region only, at level t and at t + 1, and passes from one to the
// other. Light is gathered from the unoccluded directions with its own colour.

//#include "seen.wgsl"
//#include "labelled.wgsl"
//#include "gather.wgsl"
//#include "reach.wgsl"
//#include "octahedral.wgsl"

struct Ssdo {
    samples: u32,
    near_radius: f32,
    far_radius: f32,
    strength: f32,
    bounce: f32,
    // how much the near reach counts: less with distance
    near_weight: f32,
    // how far is looked in the picture, pixels
    limit: f32,
}

@group(2) @binding(4) var<uniform> ssdo: Ssdo;
@group(2) @binding(5) var diffuse: texture_2d<f32>;
// indirect light of one bounce, as it falls on white
@group(2) @binding(6) var bounce: texture_storage_2d<rgba16float, write>;

override HAS_NEAR: bool = true;
override HAS_BOUNCE: bool = true;
// occluders of the same region count too (the thesis's comparison without semantics)
override PLAIN: bool = false;
// One direction in so many brings a bounce: it is blurred widely.
const BOUNCE_EVERY: u32 = 4u;

struct Sample {
    // 1 = the sample point lies behind what the picture shows there
    occluded: f32,
    pixel: vec2u,
    there: Labelled,
}

// Whether a view-space point lies behind the picture.
fn probe(point: vec3f, here: Seen, radius: f32) -> Sample {
    let projected = pixel_from_view(point);
    let at = vec2i(floor(projected.xy));
    if (projected.z <= 0.0 || any(at < vec2i(0)) || any(at >= vec2i(here.size))) {
        return Sample(0.0, vec2u(0u), Labelled(vec2u(0u), 0.0, 0u)); // what the picture does not show is open
    }
    let found = labelled_at(vec2u(at));
    let skin = 0.5 * pixel_width(here.depth);
    let behind = found.depth > 0.0 && found.depth <= projected.z - skin;
    // far foreground does not darken what lies behind it
    let range = smoothstep(0.0, 1.0, radius / max(abs(here.depth - found.depth), 1e-6));
    return Sample(select(0.0, range, behind), vec2u(at), found);
}

// Light that a patch of the picture sends to a point in view space: the form factor of equation 3.2
// in units of the radius, with A_s = strength / N. Direction in scene space, and its cosine.
fn sent(found: Sample, start: vec3f, direction: vec3f, cosine: f32) -> vec3f {
    let place = view_position(vec2f(found.pixel) + 0.5, found.there.depth);
    let range = max(distance(place, start), 0.1 * ssdo.near_radius);
    let normal = octahedral_decode(found.there.normal);
    let form = cosine * max(dot(normal, -direction), 0.0) * ssdo.near_radius / range;
    return form * textureLoad(diffuse, found.pixel, 0).rgb;
}

// What all directions of a pixel share.
struct Place {
    here: Seen,
    position: vec3f,
    labels: vec2u,
    noise: vec3f,
    // tangent space to scene space, and to view space
    basis: mat3x3f,
    turned: mat3x3f,
    start: vec3f,
    near_reach: f32,
    far_reach: f32,
}

// The sample point of direction i at either reach.
struct Look {
    direction: vec3f,
    cosine: f32,
    // in view space, for a reach of 1
    step: vec3f,
}

fn look(i: u32, place: Place) -> Look {
    let u = fract(halton(i) + place.noise);
    let upright = malley(u.xy);
    return Look(place.basis * upright, upright.z, u.z * (place.turned * upright));
}

fn near_probe(towards: Look, place: Place) -> Sample {
    return probe(place.start + place.near_reach * towards.step, place.here, ssdo.near_radius);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let here = seen(group, local);
    if (here.outside || here.empty) {
        return;
    }
    let noise = pixel_noise(here.pixel + vec2u(view.origin), view.seed);
    let basis = tangent_frame(here.normal);
    // sample points are made in view space, where their pixel costs least
    let start = view_position(vec2f(here.pixel) + 0.5, here.depth);
    let m = view.view_from_scene;
    let place = Place(
        here,
        seen_position(here),
        labelled_at(here.pixel).labels,
        noise,
        basis,
        mat3x3f(m[0].xyz, m[1].xyz, m[2].xyz) * basis,
        start,
        radius_within(ssdo.near_radius, start, ssdo.limit),
        radius_within(ssdo.far_radius, start, ssdo.limit),
    );
    var sum = Gathering(vec3f(0.0), 0.0);
    for (var i = 0u; i < ssdo.samples + (i >> 31u); i += 1u) {
        let towards = look(i, place);
        var near = 0.0;
        if (HAS_NEAR) {
            near = ssdo.near_weight * near_probe(towards, place).occluded;
        }
        let found = probe(start + place.far_reach * towards.step, here, ssdo.far_radius);
        var far = found.occluded;
        if (!PLAIN && far > 0.0) {
            far *= strangeness(found.there.labels, place.labels);
        }
        gather(&sum, towards.direction, (1.0 - near) * (1.0 - far), place.position);
    }
    store_gathered(here.pixel, sum, ssdo.samples, ssdo.strength);
    if (!HAS_BOUNCE) {
        return;
    }
    // light that is blurred widely needs no more than one direction in BOUNCE_EVERY: looked at once
    // more, as lavapipe runs both sides of branches
    var indirect = vec3f(0.0);
    for (var i = 0u; i < ssdo.samples + (i >> 31u); i += BOUNCE_EVERY) {
        let towards = look(i, place);
        let found = near_probe(towards, place);
        indirect += found.occluded * sent(found, start, towards.direction, towards.cosine);
    }
    let directions = (ssdo.samples + BOUNCE_EVERY - 1u) / BOUNCE_EVERY;
    let amount = ssdo.bounce * ssdo.near_weight / f32(directions);
    textureStore(bounce, here.pixel, vec4f(amount * indirect, 1.0));
}
