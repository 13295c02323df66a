// Analytic ambient occlusion: the blocking factors of each atom's nearest spheres, in closed form.

//#include "view.wgsl"
//#include "tiles.wgsl"
//#include "surface.wgsl"
//#include "sampling.wgsl"

struct Analytic {
    // texels of four neighbours a slot
    texels: u32,
    // spheres whose surface is farther than this from the point do not count
    range: f32,
    // 0 the horizon-clipped closed form, 1 Easdon's form without a horizon
    form: u32,
}

@group(2) @binding(0) var<uniform> analytic: Analytic;
@group(2) @binding(1) var surface: texture_2d<f32>;
@group(2) @binding(2) var ids: texture_2d<u32>;
// for each slot of a sphere or rod the slots of the spheres around it, nearest first
@group(2) @binding(3) var neighbours: texture_2d<u32>;
// by object, what the rows of its slots in that table are less than the slots
@group(2) @binding(5) var<storage, read> neighbours_skipped: array<u32>;
@group(2) @binding(4) var result: texture_storage_2d<r32float, write>;

// Cosine-weighted share of the hemisphere about n that a sphere blocks: c is the cosine between n
// and the direction to its center, ratio = d / r > 1. Exact, also where the sphere dips below the
// horizon (Snyder 1996, "Area light sources for real-time graphics"; Quilez).
fn sphere_occlusion(c: f32, ratio: f32) -> f32 {
    let h = max(ratio, 1.0001);
    let h2 = h * h;
    let k2 = 1.0 - h2 * c * c;
    let above = max(c, 0.0) / h2;
    // wholly above or below the horizon where k2 <= 0
    let k = max(k2, 0.0);
    let sine2 = max(1.0 - c * c, 1e-7);
    let cut = c * acos(clamp(-c * sqrt((h2 - 1.0) / sine2), -1.0, 1.0)) - sqrt(k * (h2 - 1.0));
    let dipping = (cut / h2 + atan(sqrt(k / (h2 - 1.0)))) / PI;
    return saturate(select(above, dipping, k2 > 0.0));
}

// Easdon 2013, equation 4.4: solid angle over the hemisphere, without a horizon.
fn easdon_occlusion(c: f32, ratio: f32) -> f32 {
    let h = max(ratio, 1.0001);
    return select(0.0, 1.0 - sqrt(1.0 - 1.0 / (h * h)), c > 0.0);
}

// Share of a sphere that the clipping planes keep, by the height of its center over each.
fn kept_share(center: vec3f, radius: f32) -> f32 {
    var share = 1.0;
    for (var i = 0u; i < scene.plane_count + (i >> 31u); i += 1u) {
        let height = dot(scene.planes[i].xyz, center) + scene.planes[i].w;
        share = min(share, saturate(0.5 + 0.5 * height / radius));
    }
    return share;
}

// All of an atom's neighbours belong to its own object, whose opacity is theirs.
fn open_share(
    slot: u32, p: vec3f, n: vec3f, instance: Instance, clipped: bool, opacity: f32,
) -> f32 {
    var open = 1.0;
    let row = slot - neighbours_skipped[instance.object];
    for (var i = 0u; i < analytic.texels; i += 1u) {
        let four = textureLoad(neighbours, table_place(row * analytic.texels + i), 0);
        for (var j = 0u; j < 4u; j += 1u) {
            let index = four[j];
            let sphere = slot_at(select(index, slot, index == NO_PRIMITIVE));
            let to_center = sphere.xyz - p;
            let d = length(to_center);
            let c = dot(n, to_center) / max(d, 1e-6);
            var blocked = sphere_occlusion(c, d / sphere.w);
            if (analytic.form == 1u) {
                blocked = easdon_occlusion(c, d / sphere.w);
            }
            blocked *= select(0.0, opacity, d - sphere.w < analytic.range);
            if (CLIPPED && clipped) {
                blocked *= kept_share(instance.center + rotate(instance.rotation, sphere.xyz), sphere.w);
            }
            open *= select(1.0 - blocked, 1.0, index == NO_PRIMITIVE);
        }
    }
    return open;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = tile_pixel(group, local);
    if (any(pixel >= textureDimensions(result))) {
        return;
    }
    let texel = textureLoad(surface, pixel, 0);
    let id = textureLoad(ids, pixel, 0);
    if (texel.w <= 0.0) {
        textureStore(result, pixel, vec4f(1.0));
        return;
    }
    let position = scene_position(vec2f(pixel) + 0.5, texel.w);
    let instance = numbered(id.y, id.z);
    let inverse = conjugate(instance.rotation);
    let p = rotate(inverse, position - instance.center);
    let n = rotate(inverse, texel.xyz);
    let flags = traced_object(id.z).flags;
    let clipped = (flags & UNCLIPPED) == 0u;
    var open = 1.0;
    if (kind_of(id.w) != TRIANGLE && !(clipped && on_cap(position, texel.xyz, texel.w))) {
        open = open_share(slot_of(id.w), p, n, instance, clipped, opacity_of(flags));
    }
    textureStore(result, pixel, vec4f(open));
}
