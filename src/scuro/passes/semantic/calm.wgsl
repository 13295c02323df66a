// Where a pixel holds many atoms its one sampled normal is chance: blurs that stop at edges of
// normals (blur.wgsl) would stop everywhere. They take the mean over the neighbours of the same region
// instead, over as many pixels as it takes atoms to fill one. Light itself falls on the normals as they
// are: the mean of what they reflect is less than what their mean would.
// Separable: one direction a dispatch.

//#include "seen.wgsl"
//#include "labelled.wgsl"

struct Calm {
    // (1, 0) or (0, 1)
    step: vec2i,
    // pixels of smoothing for each atom that a pixel's width holds
    reach: f32,
    // diameter of an atom, scene units
    atom: f32,
    // depths differing more are another surface, scene units
    depth_limit: f32,
}

const MOST: i32 = 5;

@group(2) @binding(2) var<uniform> calm: Calm;
// as `surface`
@group(2) @binding(3) var calmed: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let here = seen(group, local);
    if (here.outside || here.empty) {
        return;
    }
    // nothing to smooth below one atom a pixel; grows from there without a jump
    let sigma = calm.reach * max(pixel_width(here.depth) / calm.atom - 0.5, 0.0);
    if (sigma < 0.05) {
        textureStore(calmed, here.pixel, vec4f(here.normal, here.depth));
        return;
    }
    let region = labelled_at(here.pixel).labels.x;
    let reach = clamp(i32(ceil(2.0 * sigma)), 1, MOST);
    var sum = here.normal;
    for (var i = -reach; i <= reach; i += 1) {
        let at = vec2i(here.pixel) + i * calm.step;
        if (i == 0 || any(at < vec2i(0)) || any(at >= vec2i(here.size))) {
            continue;
        }
        let there = textureLoad(surface, at, 0);
        if (there.w <= 0.0 || labelled_at(vec2u(at)).labels.x != region
            || abs(there.w - here.depth) > calm.depth_limit) {
            continue;
        }
        sum += there.xyz * exp(-0.5 * f32(i * i) / (sigma * sigma));
    }
    // along x the length stays: normals that agree weigh more along y
    let length = select(2.0 * f32(reach) + 1.0, sqrt(max(dot(sum, sum), 1e-12)), calm.step.y != 0);
    textureStore(calmed, here.pixel, vec4f(sum / length, here.depth));
}
