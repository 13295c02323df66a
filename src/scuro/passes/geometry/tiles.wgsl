// Which tiles of the picture may show a surface: the projected bounding spheres of clusters of
// primitives (or, in scenes of many instances, of whole instances) are splatted into a mask.

//#include "view.wgsl"
//#include "scene.wgsl"

struct Splat {
    // clusters an instance; 0 for whole instances
    clusters: u32,
    first_cluster: u32,
    first_instance: u32,
    count: u32,
    tiles: vec2u,
    // pixels around a surface in which all passes may draw, and in which depth cues may
    margins: vec2f,
}

@group(2) @binding(0) var<uniform> splat: Splat;
@group(2) @binding(1) var<storage, read> clusters: array<vec4f>;
// of each tile: whether it shows a surface; then, whether it is beside one
@group(2) @binding(2) var<storage, read_write> tile_mask: array<atomic<u32>>;
// number of workgroups of an indirect dispatch: tiles, 1, 1
@group(2) @binding(3) var<storage, read_write> tile_count: array<atomic<u32>, 4>;
@group(2) @binding(4) var<storage, read_write> tile_list: array<u32>;
// the same of tiles in which depth cues may draw
@group(2) @binding(5) var<storage, read_write> near_count: array<atomic<u32>, 4>;
@group(2) @binding(6) var<storage, read_write> near_list: array<u32>;

// Whether depth cues reach farther than all else.
override CUES: bool = false;

@compute @workgroup_size(64)
fn mark(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    if (index >= splat.count) {
        return;
    }
    let per_instance = max(splat.clusters, 1u);
    let instance = instance_at(splat.first_instance + index / per_instance);
    var center = instance.center;
    var radius = traced_object(instance.object).radius;
    if (splat.clusters > 0u) {
        let cluster = clusters[splat.first_cluster + index % per_instance];
        center += rotate(instance.rotation, cluster.xyz);
        radius = cluster.w;
    }
    if (CLIPPED && (traced_object(instance.object).flags & UNCLIPPED) == 0u) {
        // what a plane takes away whole is not even looked for: cost follows what is left
        for (var i = 0u; i < scene.plane_count + (i >> 31u); i += 1u) {
            if (dot(scene.planes[i].xyz, center) + scene.planes[i].w < -radius) {
                return;
            }
        }
    }
    let p = (view.view_from_scene * vec4f(center, 1.0)).xyz;
    let x = picture_interval(p.x, -p.z, radius) / view.half_extent.x;
    let y = picture_interval(p.y, -p.z, radius) / view.half_extent.y;
    if (view.orthographic == 0u && -p.z < -radius) {
        return;
    }
    let first = pixel_from_picture(vec2f(x.x, y.y));
    let last = pixel_from_picture(vec2f(x.y, y.x));
    let corner = first - splat.margins.y;
    let opposite = last + splat.margins.y;
    let limit = vec2f(splat.tiles * 8u);
    if (any(opposite < vec2f(0.0)) || any(corner >= limit)) {
        return;
    }
    let low = vec2u(max(corner, vec2f(0.0))) / 8u;
    let high = min(vec2u(min(opposite, limit)) / 8u, splat.tiles - 1u);
    let within = vec4f(first - splat.margins.x, last + splat.margins.x) / 8.0;
    for (var ty = low.y; ty <= high.y; ty += 1u) {
        for (var tx = low.x; tx <= high.x; tx += 1u) {
            var place = tx + ty * splat.tiles.x;
            if (CUES) {
                // one store: each costs lavapipe a loop over the lanes, and an atomic "or" much more
                let tile = vec2f(f32(tx), f32(ty));
                let inside = all(tile + 1.0 > within.xy) && all(tile <= within.zw);
                place += select(splat.tiles.x * splat.tiles.y, 0u, inside);
            }
            atomicStore(&tile_mask[place], 1u);
        }
    }
}

@compute @workgroup_size(64)
fn gather(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= splat.tiles.x * splat.tiles.y) {
        return;
    }
    let tile = (id.x % splat.tiles.x) | ((id.x / splat.tiles.x) << 16u);
    let within = atomicLoad(&tile_mask[id.x]) != 0u;
    if (within) {
        tile_list[atomicAdd(&tile_count[0], 1u)] = tile;
    }
    if (CUES && (within || atomicLoad(&tile_mask[splat.tiles.x * splat.tiles.y + id.x]) != 0u)) {
        near_list[atomicAdd(&near_count[0], 1u)] = tile;
    }
}
