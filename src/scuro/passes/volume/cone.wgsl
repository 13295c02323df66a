// Transparency of a cone by few Gaussian samples (Campagnolo 2021, section 3.2 and appendix A).

//#include "volume.wgsl"

const MAX_SECTIONS: u32 = 128u;

struct Cone {
    // samples with one, three and seven cones
    counts: vec3u,
    // deviation of the pyramid's first level, in voxel edges
    sigma: f32,
    // distance from the apex of the first sample of each kind
    starts: vec3f,
    // tangent of the half-angle
    tangent: f32,
    // alpha of equation 3-17
    attenuation: f32,
    // scene units beyond which nothing is met
    reach: f32,
    // 1, 4 or 11: the whole cone, its three parts, their seven
    parts: u32,
    // how much the matter of a cross-section stands in rows: 0 for none of it
    correlation: f32,
    // no light worth telling gets through a larger optical depth
    opaque: f32,
    // for each sample: distance to the next, level, A_tau, h_I; lengths in voxel edges
    sections: array<vec4f, MAX_SECTIONS>,
}

const OCCLUSION_CONE: u32 = 0u;
const SHADOW_CONE: u32 = 1u;

struct Cones {
    kinds: array<Cone, 2>,
}

@group(1) @binding(6) var<uniform> cones: Cones;
// extinction coefficients per voxel edge
@group(1) @binding(7) var pyramid: texture_3d<f32>; // filterable

const THREE_OFFSET: f32 = 0.53589838;
const SEVEN_OFFSET: f32 = 0.66666667;

// Algorithm 1. Outside the volume the nearest value falls off with the distance to the border, as
// a Gaussian: the printed exp(-d / 2 sigma^2) lacks the square of the distance.
fn representative(uvw: vec3f, mip: f32, sigma: f32) -> f32 {
    let inside = clamp(uvw, vec3f(0.0), vec3f(1.0));
    let beyond = uvw - inside;
    var fall = 1.0;
    if (any(beyond != vec3f(0.0))) {
        let away = beyond * volume.edges / sigma;
        fall = exp(-0.5 * dot(away, away));
        if (fall < 0.01) {
            return 0.0;
        }
    }
    // a single fetch, whichever side: two would both be run by every group of lanes
    return fall * textureSampleLevel(pyramid, trilinear, inside, mip).r;
}

// Two unit vectors that with `axis` make a right-handed frame (Duff et al. 2017).
fn frame_around(axis: vec3f) -> mat2x3f {
    let s = select(-1.0, 1.0, axis.z >= 0.0);
    let a = -1.0 / (s + axis.z);
    let b = axis.x * axis.y * a;
    return mat2x3f(
        vec3f(1.0 + s * axis.x * axis.x * a, s * b, -s * axis.x),
        vec3f(b, s + axis.y * axis.y * a, -axis.y),
    );
}

// Offset of a part's axis from the cone's, in radii of the cone's section: none for the whole (0),
// three around it (1 to 3), one in the middle (4) and six around it (5 to 10).
fn part_offset(part: u32) -> vec2f {
    var angle = 2.0943951 * f32(part - 1u);
    var distance = THREE_OFFSET;
    if (part > 4u) {
        angle = 1.0471976 * (f32(part - 5u) - 0.5);
        distance = SEVEN_OFFSET;
    }
    if (part == 0u || part == 4u) {
        distance = 0.0;
    }
    return distance * vec2f(cos(angle), sin(angle));
}

// Mean share of light that gets through rays whose optical depths differ: exp(-depth) where all are
// alike. Rays that meet opaque matter meet it again behind, those beside it meet none, and their
// exponentials' mean is larger than the exponential of their mean: with depths spread as a gamma
// distribution of relative variance C, it is (1 + C depth)^(-1/C) (Davis and Mineev-Weinstein 2011).
fn transmitted(depth: f32, correlation: f32) -> f32 {
    let c = max(correlation, 1e-3);
    return select(exp(-depth), pow(1.0 + c * depth, -1.0 / c), correlation > 0.0);
}

// Share of the light that arrives at `apex` through the cone about `axis` (unit) from no farther
// than `limit` scene units. Algorithms 2, 3 and 4 of appendix A in one: a part of the cone starts
// with what the part that it was split from has met. One loop holds the only texture fetch, since
// software adapters run every branch for every group of lanes.
fn cone_transparency(kind: u32, apex: vec3f, axis: vec3f, limit: f32) -> f32 {
    let counts = cones.kinds[kind].counts;
    let tangent = cones.kinds[kind].tangent;
    let attenuation = cones.kinds[kind].attenuation;
    let parts = cones.kinds[kind].parts;
    let opaque = cones.kinds[kind].opaque;
    let end = min(limit, cones.kinds[kind].reach) / volume.voxel;
    let origin = texture_position(apex);
    let around = frame_around(axis);
    // optical depth, and the last amplitude, of every part
    var depths: array<f32, 11>;
    var lasts: array<f32, 11>;
    var sum = 0.0;
    var total = 0.0;
    for (var part = 0u; part < parts; part++) {
        let offset = part_offset(part) * tangent;
        let direction = texture_direction(normalize(axis + around * offset)) * volume.voxel;
        let stage = select(select(2u, 1u, part < 4u), 0u, part == 0u);
        var depth = 0.0;
        var last = 0.0;
        if (stage == 1u) {
            depth = depths[0];
            last = lasts[0];
        } else if (part == 4u) {
            depth = (depths[1] + depths[2] + depths[3]) / 3.0;
            last = (lasts[1] + lasts[2] + lasts[3]) / 3.0;
        } else if (stage == 2u) {
            depth = depths[(part - 3u) / 2u];
            last = lasts[(part - 3u) / 2u];
        }
        let first = select(select(counts.x + counts.y, counts.x, stage == 1u), 0u, stage == 0u);
        let after = first + counts[stage];
        var d = cones.kinds[kind].starts[stage];
        for (var i = first; i < after; i++) {
            let s = cones.kinds[kind].sections[i];
            let sigma = cones.kinds[kind].sigma * exp2(s.y);
            let now = representative(origin + d * direction, s.y, sigma) * s.z;
            depth += (last + now) * s.w * attenuation;
            last = now;
            d += s.x;
            if (depth > opaque || d > end) {
                break;
            }
        }
        depths[part] = depth;
        lasts[part] = last;
        if (parts == 1u || (parts == 4u && part > 0u) || part > 3u) {
            // cosine-weighted mean of the last parts
            let weight = inverseSqrt(1.0 + dot(offset, offset));
            sum += weight * transmitted(depth, cones.kinds[kind].correlation);
            total += weight;
        }
    }
    return sum / total;
}
