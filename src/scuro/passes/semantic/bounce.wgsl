// Pass 4: one bounce of indirect light from what lies within the near reach (equation 3.2). It is
// blurred widely, so one pixel in four gathers it, from one direction in four.

//#include "probe.wgsl"
//#include "octahedral.wgsl"

struct Bounce {
    // of the occlusion
    samples: u32,
    radius: f32,
    strength: f32,
    // how far is looked in the picture, pixels
    limit: f32,
}

@group(2) @binding(2) var<uniform> bounced: Bounce;
@group(2) @binding(3) var diffuse: texture_2d<f32>;
// indirect light of one bounce, as it falls on white
@group(2) @binding(4) var bounce: texture_storage_2d<rgba16float, write>;

const EVERY: u32 = 4u;

// Light that a patch of the picture sends to a point in view space: the form factor of equation 3.2
// in units of the radius, with A_s = strength / N. Direction in scene space, and its cosine.
fn sent(found: Sample, start: vec3f, direction: vec3f, cosine: f32) -> vec3f {
    let place = view_position(vec2f(found.pixel) + 0.5, found.there.depth);
    let range = max(distance(place, start), 0.1 * bounced.radius);
    let normal = octahedral_decode(found.there.normal);
    let form = cosine * max(dot(normal, -direction), 0.0) * bounced.radius / range;
    return form * textureLoad(diffuse, found.pixel, 0).rgb;
}

@compute @workgroup_size(8, 2)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let here = seen_thinly(group, local);
    if (here.outside || here.empty) {
        return;
    }
    let place = place_of(here);
    let reach = radius_within(bounced.radius, place.start, bounced.limit);
    var sum = vec3f(0.0);
    for (var i = 0u; i < bounced.samples + (i >> 31u); i += EVERY) {
        let towards = look(i, place);
        let found = probe(place.start + reach * towards.step, here, bounced.radius);
        sum += found.occluded * sent(found, place.start, towards.direction, towards.cosine);
    }
    let directions = (bounced.samples + EVERY - 1u) / EVERY;
    textureStore(bounce, here.pixel, vec4f(bounced.strength / f32(directions) * sum, 1.0));
}
