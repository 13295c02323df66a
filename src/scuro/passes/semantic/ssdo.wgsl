// Pass 3: screen-space directional occlusion between regions (Algorithm 2).
//
// Two reaches: the near one tells atoms apart and fades out as the camera goes away; the far one
// counts occluders of another region only, at level t and at t + 1, and passes from one to the
// other. Light is gathered from the unoccluded directions with its own colour.

//#include "probe.wgsl"
//#include "gather.wgsl"

struct Ssdo {
    samples: u32,
    near_radius: f32,
    far_radius: f32,
    strength: f32,
    // how much the near reach counts: less with distance
    near_weight: f32,
    // how far is looked in the picture, pixels
    limit: f32,
}

@group(2) @binding(4) var<uniform> ssdo: Ssdo;

override HAS_NEAR: bool = true;
// occluders of the same region count too (the thesis's comparison without semantics)
override PLAIN: bool = false;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let here = seen(group, local);
    if (here.outside || here.empty) {
        return;
    }
    let place = place_of(here);
    let start = place.start;
    let position = seen_position(here);
    let labels = labelled_at(here.pixel).labels;
    let near_reach = radius_within(ssdo.near_radius, start, ssdo.limit);
    let far_reach = radius_within(ssdo.far_radius, start, ssdo.limit);
    var sum = Gathering(vec3f(0.0), 0.0);
    for (var i = 0u; i < ssdo.samples + (i >> 31u); i += 1u) {
        let towards = look(i, place);
        var near = 0.0;
        if (HAS_NEAR) {
            let found = probe(start + near_reach * towards.step, here, ssdo.near_radius);
            near = ssdo.near_weight * found.occluded;
        }
        let found = probe(start + far_reach * towards.step, here, ssdo.far_radius);
        var far = found.occluded;
        if (!PLAIN && far > 0.0) {
            far *= strangeness(found.there.labels, labels);
        }
        gather(&sum, towards.direction, (1.0 - near) * (1.0 - far), position);
    }
    store_gathered(here.pixel, sum, ssdo.samples, ssdo.strength);
}
