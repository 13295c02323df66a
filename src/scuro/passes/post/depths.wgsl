// The G-buffer's depth by itself, huge where empty, for passes that read many neighbours. A line
// around a surface lies at the surface's depth.

//#include "tiles.wgsl"

struct Depths {
    // width of lines, in pixels of this frame
    lines: f32,
}

@group(2) @binding(2) var<uniform> lined: Depths;
@group(2) @binding(0) var surface: texture_2d<f32>;
@group(2) @binding(1) var depths: texture_storage_2d<r32float, write>;

// As passes/post/depth.py clears it.
const FAR: f32 = 3.0e38;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let id = tile_pixel(group, local);
    if (any(id >= textureDimensions(depths))) {
        return;
    }
    let last = vec2i(textureDimensions(surface)) - 1;
    let own = textureLoad(surface, id, 0).w;
    var nearest = select(FAR, own, own > 0.0);
    for (var ring = lined.lines; ring > 0.25; ring = select(0.0, 0.5 * ring, ring > 1.0)) {
        for (var i = 0u; i < 8u; i += 1u) {
            let angle = 0.785398163 * f32(i);
            let step = vec2i(round(ring * vec2f(cos(angle), sin(angle))));
            let depth = textureLoad(surface, clamp(vec2i(id) + step, vec2i(0), last), 0).w;
            nearest = min(nearest, select(FAR, depth, depth > 0.0));
        }
    }
    textureStore(depths, id, vec4f(nearest));
}
