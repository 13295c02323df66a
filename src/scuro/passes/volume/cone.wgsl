// Transparency of a cone by few Gaussian samples (Campagnolo 2021, section 3.2 and appendix A).

//#include "volume.wgsl"

const MAX_SECTIONS: u32 = 128u;

struct Cone {
    // for each sample: distance to the next, level, A_tau, h_I; lengths in voxel edges
    sections: array<vec4f, MAX_SECTIONS>,
    // samples with one, three and seven cones; w unused
    counts: vec4u,
    // from the apex to the first sample, in voxel edges
    gap: f32,
    // tangent of the half-angle
    tangent: f32,
    // alpha of equation 3-17
    attenuation: f32,
    // deviation of the pyramid's first level, in voxel edges
    sigma: f32,
}

@group(1) @binding(6) var<uniform> occlusion_cone: Cone;
@group(1) @binding(7) var<uniform> shadow_cone: Cone;
// extinction coefficients per voxel edge
@group(1) @binding(8) var pyramid: texture_3d<f32>; // filterable

const THREE_OFFSET: f32 = 0.53589838;
const SEVEN_OFFSET: f32 = 0.66666667;
// no light worth telling gets through more than this
const OPAQUE: f32 = 6.0;

// Algorithm 1. Outside the volume the nearest value falls off with the distance to the border, as
// a Gaussian: the printed exp(-d / 2 sigma^2) lacks the square of the distance.
fn representative(uvw: vec3f, mip: f32, sigma: f32) -> f32 {
    let inside = clamp(uvw, vec3f(0.0), vec3f(1.0));
    let beyond = uvw - inside;
    if (all(beyond == vec3f(0.0))) {
        return textureSampleLevel(pyramid, trilinear, uvw, mip).r;
    }
    let away = (volume.scene_from_texture * vec4f(beyond, 0.0)).xyz / volume.voxel;
    let square = dot(away, away) / (sigma * sigma);
    if (square > 9.0) {
        return 0.0;
    }
    return textureSampleLevel(pyramid, trilinear, inside, mip).r * exp(-0.5 * square);
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

fn section(shadow: bool, i: u32) -> vec4f {
    if (shadow) {
        return shadow_cone.sections[i];
    }
    return occlusion_cone.sections[i];
}

// Share of the light that arrives at `apex` through the cone about `axis` (unit), which ends after
// `limit` scene units. Algorithms 2, 3 and 4 of appendix A.
fn cone_transparency(shadow: bool, apex: vec3f, axis: vec3f, limit: f32) -> f32 {
    var counts = occlusion_cone.counts;
    var setup = vec4f(occlusion_cone.gap, occlusion_cone.tangent, occlusion_cone.attenuation,
        occlusion_cone.sigma);
    if (shadow) {
        counts = shadow_cone.counts;
        setup = vec4f(shadow_cone.gap, shadow_cone.tangent, shadow_cone.attenuation,
            shadow_cone.sigma);
    }
    let origin = texture_position(apex);
    let main = texture_direction(axis) * volume.voxel;
    let end = limit / volume.voxel;
    var d = setup.x;
    var depth = 0.0;
    var last = 0.0;
    for (var i = 0u; i < counts.x; i++) {
        let s = section(shadow, i);
        let now = representative(origin + d * main, s.y, setup.w * exp2(s.y)) * s.z;
        depth += (last + now) * s.w * setup.z;
        last = now;
        d += s.x;
        if (depth > OPAQUE || d > end) {
            return exp(-depth);
        }
    }
    if (counts.y + counts.z == 0u) {
        return exp(-depth);
    }

    // split in three: all inherit what was met so far
    let around = frame_around(axis);
    let spread3 = THREE_OFFSET * setup.y;
    var w3: array<vec3f, 3>;
    for (var k = 0; k < 3; k++) {
        let angle = 2.0943951 * f32(k);
        let side = around * vec2f(cos(angle), sin(angle));
        w3[k] = texture_direction(normalize(axis + spread3 * side)) * volume.voxel;
    }
    var depth3 = vec3f(depth);
    var last3 = vec3f(last);
    for (var i = counts.x; i < counts.x + counts.y; i++) {
        let s = section(shadow, i);
        let sigma = setup.w * exp2(s.y);
        let now = vec3f(
            representative(origin + d * w3[0], s.y, sigma),
            representative(origin + d * w3[1], s.y, sigma),
            representative(origin + d * w3[2], s.y, sigma),
        ) * s.z;
        depth3 += (last3 + now) * s.w * setup.z;
        last3 = now;
        d += s.x;
        if (all(depth3 > vec3f(OPAQUE)) || d > end) {
            break;
        }
    }
    if (counts.z == 0u || all(depth3 > vec3f(OPAQUE)) || d > end) {
        return dot(exp(-depth3), vec3f(1.0 / 3.0));
    }

    // in seven: the middle one inherits the mean, the others the nearest of the three
    let spread7 = SEVEN_OFFSET * setup.y;
    var w7: array<vec3f, 6>;
    for (var k = 0; k < 6; k++) {
        let angle = 1.0471976 * (f32(k) - 0.5);
        let side = around * vec2f(cos(angle), sin(angle));
        w7[k] = texture_direction(normalize(axis + spread7 * side)) * volume.voxel;
    }
    var depth7 = dot(depth3, vec3f(1.0 / 3.0));
    var last7 = dot(last3, vec3f(1.0 / 3.0));
    var depth_a = vec3f(depth3.x, depth3.x, depth3.y);
    var depth_b = vec3f(depth3.y, depth3.z, depth3.z);
    var last_a = vec3f(last3.x, last3.x, last3.y);
    var last_b = vec3f(last3.y, last3.z, last3.z);
    for (var i = counts.x + counts.y; i < counts.x + counts.y + counts.z; i++) {
        let s = section(shadow, i);
        let sigma = setup.w * exp2(s.y);
        let middle = representative(origin + d * main, s.y, sigma) * s.z;
        let now_a = vec3f(
            representative(origin + d * w7[0], s.y, sigma),
            representative(origin + d * w7[1], s.y, sigma),
            representative(origin + d * w7[2], s.y, sigma),
        ) * s.z;
        let now_b = vec3f(
            representative(origin + d * w7[3], s.y, sigma),
            representative(origin + d * w7[4], s.y, sigma),
            representative(origin + d * w7[5], s.y, sigma),
        ) * s.z;
        let weight = s.w * setup.z;
        depth7 += (last7 + middle) * weight;
        depth_a += (last_a + now_a) * weight;
        depth_b += (last_b + now_b) * weight;
        last7 = middle;
        last_a = now_a;
        last_b = now_b;
        d += s.x;
        if (d > end || (depth7 > OPAQUE && all(depth_a > vec3f(OPAQUE))
            && all(depth_b > vec3f(OPAQUE)))) {
            break;
        }
    }
    // cosine of the angle between the axis and the outer cones' axes
    let lean = inverseSqrt(1.0 + spread7 * spread7);
    let outer = dot(exp(-depth_a), vec3f(1.0)) + dot(exp(-depth_b), vec3f(1.0));
    return (exp(-depth7) + lean * outer) / (1.0 + 6.0 * lean);
}
