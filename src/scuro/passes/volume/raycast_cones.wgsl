// The volume's picture with cones traced from every sample of every ray (image space).

//#include "march.wgsl"
//#include "lit.wgsl"
//#include "illumination.wgsl"

@group(2) @binding(6) var volume_color: texture_storage_2d<rgba16float, write>;
@group(2) @binding(7) var volume_depth: texture_storage_2d<r32float, write>;

fn light_at(point: Point) -> vec3f {
    if (is_due(point)) {
        latest = illumination(point.position);
    }
    return lit(point, latest.x, latest.yzw);
}

struct Pieces {
    index: u32,
}

@group(2) @binding(4) var<uniform> pieces: Pieces;
// for each pixel: color so far; what is left through, next sample, distance of half the opacity
@group(2) @binding(5) var<storage, read_write> sums: array<vec4f>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= march.width || id.y >= march.height) {
        return;
    }
    let at = 2u * (id.y * march.width + id.x);
    var color = vec3f(0.0);
    var state = vec3f(1.0, 0.0, 0.0);
    if (pieces.index > 0u) {
        color = sums[at].rgb;
        state = sums[at + 1u].xyz;
    }
    if (state.y >= ENDED) {
        return;
    }
    piece = state.xy;
    let result = integrate(id.xy);
    color += result.color.rgb;
    if (ISOSURFACE) { // has a single sample
        piece = vec2f(1.0 - result.color.a, ENDED);
    }
    sums[at] = vec4f(color, 0.0);
    let t = max(state.z, result.t);
    sums[at + 1u] = vec4f(piece, t, 0.0);
    textureStore(volume_color, id.xy, whole(color, piece.x));
    let forward = -view_ray(vec2f(id.xy) + 0.5).direction.z;
    textureStore(volume_depth, id.xy, vec4f(t * forward));
}
