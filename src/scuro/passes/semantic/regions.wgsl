// Pass 1 of Koch's pipeline: the region of every pixel at level t and at t + 1 (Algorithm 1).

//#include "tiles.wgsl"
//#include "region.wgsl"
//#include "octahedral.wgsl"

@group(2) @binding(0) var ids: texture_2d<u32>;
@group(2) @binding(1) var surface: texture_2d<f32>;
// region at level t, region at t + 1; 0 where empty; the bits of the depth along -z, the
// normal as an octahedral pair
@group(2) @binding(2) var regions: texture_storage_2d<rgba32uint, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = tile_pixel(group, local);
    let size = textureDimensions(regions);
    if (any(pixel >= size)) {
        return;
    }
    let found = textureLoad(ids, pixel, 0);
    if (found.z == 0xffffffffu) {
        return;
    }
    let here = region_of(levels.here, found.z, found.y, found.x);
    let next = region_of(levels.next, found.z, found.y, found.x);
    let seen = textureLoad(surface, pixel, 0);
    let normal = octahedral_encode(seen.xyz);
    textureStore(regions, pixel, vec4u(here, next, bitcast<u32>(seen.w), normal));
}
