// Context (context.py) whose edges are as smooth as those of path tracing: means over frames of it, each
// from another place within the pixels.

//#include "tiles.wgsl"

struct Means {
    // which frame this is
    index: u32,
}

@group(2) @binding(0) var<uniform> means: Means;
// sums of premultiplied light for each pixel: of what is before the scene, then of all else
@group(2) @binding(1) var<storage, read_write> context_sums: array<vec4f>;
// of the context
@group(2) @binding(2) var context_surface: texture_2d<f32>;
@group(2) @binding(3) var context_color: texture_2d<f32>;
// of the scene
@group(2) @binding(4) var surface: texture_2d<f32>;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = tile_pixel(group, local);
    if (any(pixel >= textureDimensions(surface))) {
        return;
    }
    let light = textureLoad(context_color, pixel, 0);
    let depth = textureLoad(surface, pixel, 0).w;
    // where the scene's middle misses the pixel, what may be seen of its edge is before the context
    let before = depth > 0.0 && textureLoad(context_surface, pixel, 0).w < depth;
    let at = 2u * (pixel.x + pixel.y * textureDimensions(surface).x);
    let first = means.index == 0u;
    context_sums[at] = select(context_sums[at], vec4f(0.0), first)
        + select(vec4f(0.0), light, before);
    context_sums[at + 1u] = select(context_sums[at + 1u], vec4f(0.0), first)
        + select(light, vec4f(0.0), before);
}
