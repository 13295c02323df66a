// Looking up baked visibility: one bilinear fetch a pixel.

//#include "view.wgsl"
//#include "tiles.wgsl"
//#include "surface.wgsl"
//#include "sampling.wgsl"

struct Baked {
    edge: u32,
    columns: u32,
}

@group(2) @binding(0) var<uniform> baked: Baked;
@group(2) @binding(1) var surface: texture_2d<f32>;
@group(2) @binding(2) var ids: texture_2d<u32>;
// patch of each slot; NO_PRIMITIVE for none
@group(2) @binding(3) var<storage, read> patch_of: array<u32>;
@group(2) @binding(4) var atlas: texture_2d<f32>;
@group(2) @binding(5) var result: texture_storage_2d<r32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = tile_pixel(group, local);
    if (any(pixel >= textureDimensions(result))) {
        return;
    }
    let texel = textureLoad(surface, pixel, 0);
    let id = textureLoad(ids, pixel, 0);
    let which = patch_of[select(slot_of(id.w), 0u, texel.w <= 0.0)];
    if (texel.w <= 0.0 || which == NO_PRIMITIVE) {
        textureStore(result, pixel, vec4f(1.0));
        return;
    }
    let position = scene_position(vec2f(pixel) + 0.5, texel.w);
    if ((traced_object(id.z).flags & UNCLIPPED) == 0u && on_cap(position, texel.xyz, texel.w)) {
        // no texel of the sphere lies on its cap
        textureStore(result, pixel, vec4f(1.0));
        return;
    }
    let instance = numbered(id.y, id.z);
    let p = rotate(conjugate(instance.rotation), position - instance.center);
    let a = slot_at(slot_of(id.w));
    var at: vec2f;
    if (kind_of(id.w) == SPHERE) {
        at = octahedral_square(normalize(p - a.xyz)) * 0.5 + 0.5;
    } else {
        let b = slot_at(slot_of(id.w) + 1u);
        let axis = b.xyz - a.xyz;
        let frame = tangent_frame(normalize(axis));
        let off = p - a.xyz;
        at = vec2f(
            saturate(dot(off, axis) / dot(axis, axis)),
            fract(atan2(dot(off, frame[1]), dot(off, frame[0])) / (2.0 * PI) + 1.0),
        );
    }
    // from the middle of the first border texel
    let place = at * f32(baked.edge) + 0.5;
    let base = vec2u(floor(place));
    let part = fract(place);
    let corner = vec2u(which % baked.columns, which / baked.columns) * (baked.edge + 2u) + base;
    let low = mix(textureLoad(atlas, corner, 0).x, textureLoad(atlas, corner + vec2u(1u, 0u), 0).x, part.x);
    let high = mix(textureLoad(atlas, corner + vec2u(0u, 1u), 0).x,
        textureLoad(atlas, corner + vec2u(1u, 1u), 0).x, part.x);
    textureStore(result, pixel, vec4f(mix(low, high, part.y)));
}
