// Depth-aware borders (Tarini et al. 2006): a line lies outside of a silhouette, on what is behind
// it, and is as wide as the depth jump there allows. Between touching atoms it thins out to nothing.

struct Borders {
    // linear
    color: vec3f,
    opacity: f32,
    // widest line, in pixels of this frame
    width: f32,
    // one over the depth jump of the widest line
    per_jump: f32,
    // width of a pixel: at depth 1, or anywhere (orthographic)
    pixel: f32,
    // how far rays through neighbouring pixels part at depth 1
    opening: f32,
}

@group(2) @binding(10) var<uniform> borders: Borders;

// Steeper surfaces than this are taken for an edge.
const STEEPEST: f32 = 8.0;
// How far smoothed normals may be off, as a slope.
const FACETS: f32 = 0.15;
const FAR: f32 = 3.0e38;

// A pixel's own surface, from which others may stand out.
struct Ground {
    depth: f32,
    // change of depth a pixel to the right and downward: what a tangent plane explains is no jump,
    // and a convex surface never stands out from its own tangent plane
    slope: vec2f,
    // facets and rounding make steps of less than the pixels are wide, and facets of steep surfaces,
    // whose normals are smoothed, more
    grain: f32,
}

fn ground_at(pixel: vec2u, texel: vec4f) -> Ground {
    if (texel.w <= 0.0) {
        return Ground(FAR, vec2f(0.0), 0.0);
    }
    let to_view = view.view_from_scene;
    let normal = to_view[0].xyz * texel.x + to_view[1].xyz * texel.y + to_view[2].xyz * texel.z;
    let right_down = vec2f(normal.x, -normal.y);
    // along a ray through the pixel that goes one unit ahead
    let ray = (vec2f(pixel) + 0.5 + view.origin - 0.5 * view.size) * borders.opening;
    let facing = normal.z - dot(right_down, ray);
    let steep = right_down * (1.0 / max(facing, 1.0 / STEEPEST));
    let width = borders.pixel * select(texel.w, 1.0, view.orthographic != 0u);
    return Ground(texel.w, steep * width, width * (1.0 + FACETS * dot(steep, steep)));
}

// How far four others stand out from the pixel's surface: their offset and depth (0 where empty).
fn jumps(ground: Ground, xs: vec4f, ys: vec4f, depths: vec4f) -> vec4f {
    let rise = min(ground.slope.x * xs + ground.slope.y * ys, vec4f(0.0));
    return select(vec4f(0.0), ground.depth + rise - depths, depths > vec4f(0.0));
}

// The pixel's share of lines around four others: their distance and jump. A line begins half a pixel
// from its surface's last.
fn shares(away: vec4f, jump: vec4f) -> vec4f {
    let width = borders.width * sqrt(saturate(jump * borders.per_jump));
    return select(vec4f(0.0), saturate(width + 1.0 - away), jump > vec4f(0.0));
}

// Lines of at most two pixels: the 16 texels of four gathered squares, which turn about the pixel.
fn thin_line(pixel: vec2u, texel: vec4f) -> f32 {
    let ground = ground_at(pixel, texel);
    let scale = 1.0 / vec2f(textureDimensions(surface));
    var corner = vec2f(2.0, 0.0);
    // of the four texels at each distance, the one that stands out most has the widest line
    var away = sqrt(vec4f(1.0, 4.0, 5.0, 2.0));
    var jump = vec4f(0.0);
    for (var i = 0u; i < 4u; i += 1u) {
        // the sampler repeats the last texels beyond the picture
        let depths = textureGather(3, surface, nearest, (vec2f(pixel) + corner) * scale);
        let xs = corner.x + vec4f(-1.0, 0.0, 0.0, -1.0);
        let ys = corner.y + vec4f(0.0, 0.0, -1.0, -1.0);
        // a quarter turn on, each distance comes one later
        jump = max(jump, jumps(ground, xs, ys, depths)).yzwx;
        away = away.yzwx;
        corner = vec2f(1.0 - corner.y, corner.x);
    }
    let covered = shares(away, jump - away * ground.grain);
    return borders.opacity * max(max(covered.x, covered.y), max(covered.z, covered.w));
}

// Wider lines: all texels as near as the widest line reaches.
fn wide_line(pixel: vec2u, texel: vec4f) -> f32 {
    let ground = ground_at(pixel, texel);
    let reach = borders.width + 1.0;
    var covered = 0.0;
    for (var x = 1.0; x < reach; x += 1.0) {
        for (var y = 0.0; x * x + y * y < reach * reach; y += 1.0) {
            // four at right angles, turned from one to the next; empty beyond the picture
            let xs = vec4f(x, -y, -x, y);
            let ys = vec4f(y, x, -y, -x);
            let columns = vec4i(vec4f(f32(pixel.x)) + xs);
            let rows = vec4i(vec4f(f32(pixel.y)) + ys);
            let depths = vec4f(
                textureLoad(surface, vec2i(columns.x, rows.x), 0).w,
                textureLoad(surface, vec2i(columns.y, rows.y), 0).w,
                textureLoad(surface, vec2i(columns.z, rows.z), 0).w,
                textureLoad(surface, vec2i(columns.w, rows.w), 0).w,
            );
            let jump = jumps(ground, xs, ys, depths);
            let away = length(vec2f(x, y));
            let most = max(max(jump.x, jump.y), max(jump.z, jump.w)) - away * ground.grain;
            covered = max(covered, shares(vec4f(away), vec4f(most)).x);
        }
    }
    return borders.opacity * covered;
}
