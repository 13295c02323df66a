// Depth-aware borders (Tarini et al. 2006): a line lies outside of a silhouette, on what is behind
// it, and is as wide as the depth jump there allows. Between touching atoms it thins out to nothing.

//#include "view.wgsl"
//#include "tiles.wgsl"

struct Borders {
    // linear
    color: vec3f,
    opacity: f32,
    // widest line, in pixels of this frame
    width: f32,
    // depth jump of the widest line
    jump: f32,
}

@group(2) @binding(0) var<uniform> borders: Borders;
@group(2) @binding(1) var surface: texture_2d<f32>;
// its depth alone, huge where empty
@group(2) @binding(2) var depths: texture_2d<f32>;
@group(2) @binding(3) var color: texture_2d<f32>;
@group(2) @binding(4) var replaced: texture_storage_2d<rgba16float, write>;

// Steeper surfaces than this are taken for an edge.
const STEEPEST: f32 = 8.0;

// Change of depth a pixel along a surface, to the right and downward: what a tangent plane explains
// is no jump, and a convex surface never stands out from its own tangent plane.
fn slope(pixel: vec2f, texel: vec4f) -> vec2f {
    let normal = (view.view_from_scene * vec4f(texel.xyz, 0.0)).xyz;
    let facing = dot(normal, -view_ray(pixel).direction);
    let steep = vec2f(normal.x, -normal.y) / max(facing, 1.0 / STEEPEST);
    return steep * pixel_width(texel.w);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let id = tile_pixel(group, local);
    let size = vec2i(textureDimensions(replaced));
    let pixel = vec2i(id);
    if (any(pixel >= size)) {
        return;
    }
    let here = textureLoad(surface, pixel, 0);
    let own = textureLoad(depths, pixel, 0).x;
    let rise = select(vec2f(0.0), slope(vec2f(pixel) + 0.5, here), here.w > 0.0);
    let directions = select(12u, 8u, borders.width < 3.0);
    let angle = 6.2831853 / f32(directions);
    let turn = mat2x2f(cos(angle), sin(angle), -sin(angle), cos(angle));
    var covered = 0.0;
    for (var ring = 1.0; ring < borders.width + 1.0; ring += 1.0) {
        // how far the nearest surface on a ring around the pixel stands out
        var jump = 0.0;
        // facets and rounding make steps of less than the pixels are wide
        let step_size = ring * pixel_width(here.w) * f32(here.w > 0.0);
        var offset = vec2f(ring, 0.0);
        for (var i = 0u; i < directions; i += 1u) {
            let step = round(offset);
            let place = clamp(pixel + vec2i(step), vec2i(0), size - 1);
            let expected = own + min(dot(rise, step), 0.0);
            jump = max(jump, expected - textureLoad(depths, place, 0).x);
            offset = turn * offset;
        }
        let width = borders.width * sqrt(saturate((jump - step_size) / borders.jump));
        // the pixel's share of a line that begins half a pixel from the surface's last
        covered = max(covered, saturate(width + 1.0 - ring) * f32(jump > step_size));
    }
    covered *= borders.opacity;
    let under = textureLoad(color, pixel, 0);
    textureStore(replaced, pixel, mix(under, vec4f(borders.color, 1.0), covered));
}
