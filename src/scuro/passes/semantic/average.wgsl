// The running mean of a noisy buffer over the frames of a resting camera.

//#include "seen.wgsl"

struct Averaging {
    // what this frame counts for: one over the number of frames
    share: f32,
}

@group(2) @binding(1) var<uniform> averaging: Averaging;
@group(2) @binding(2) var source: texture_2d<f32>;
@group(2) @binding(3) var mean_before: texture_2d<f32>;
@group(2) @binding(4) var mean: texture_storage_2d<rgba32float, write>;

fn average_at(here: Seen) {
    if (here.outside || here.empty) {
        return;
    }
    let fresh = textureLoad(source, here.pixel, 0);
    let before = textureLoad(mean_before, here.pixel, 0);
    // the first frame must not take over what earlier pictures left in the texture
    let mixed = select(mix(before, fresh, averaging.share), fresh, averaging.share >= 1.0);
    textureStore(mean, here.pixel, mixed);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    average_at(seen(group, local));
}

@compute @workgroup_size(8, 2)
fn thinly(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    average_at(seen_thinly(group, local));
}
