// What Gaussian cones are compared with: voxel cones (Shih et al. 2016), extinction from a summed
// area table (Schlegel et al. 2011), and local spherical ambient occlusion (Hernell et al. 2010).

//#include "cone.wgsl"

// extinction per voxel edge in 1024ths, summed from the first voxel to each; sums wrap around, and
// differences of four of them come out right all the same
@group(1) @binding(9) var<storage, read> summed: array<u32>;

const GAUSSIAN: u32 = 0u;
const VOXEL_CONES: u32 = 1u;
const SUMMED_AREA: u32 = 2u;
const LOCAL_SPHERE: u32 = 3u;

override METHOD: u32 = 0;
// length of the short rays, in voxel edges
override LOCAL_RADIUS: f32 = 8.0;

// Samples as long as the cone is wide, from the level whose texels are as wide.
fn voxel_cone_transparency(kind: u32, apex: vec3f, axis: vec3f, limit: f32) -> f32 {
    let end = min(limit, cones.kinds[kind].reach) / volume.voxel;
    let origin = texture_position(apex);
    let direction = texture_direction(axis) * volume.voxel;
    var depth = 0.0;
    var d = cones.kinds[kind].starts.x;
    for (; d < end && depth < cones.kinds[kind].opaque;) {
        let width = max(2.0 * d * cones.kinds[kind].tangent, 1.0);
        let uvw = origin + (d + 0.5 * width) * direction;
        let inside = all(uvw == clamp(uvw, vec3f(0.0), vec3f(1.0)));
        let extinction = textureSampleLevel(pyramid, trilinear, uvw, round(log2(width))).r;
        depth += select(0.0, extinction * width, inside) * cones.kinds[kind].attenuation;
        d += width;
    }
    return exp(-depth);
}

fn sum_to(voxel: vec3i) -> u32 {
    if (any(voxel < vec3i(0))) {
        return 0u;
    }
    let n = vec3i(volume.size);
    let at = min(voxel, n - 1);
    return summed[(at.z * n.y + at.y) * n.x + at.x];
}

// Extinction summed over the voxels from `low` to `high`, both included.
fn box_sum(low: vec3i, high: vec3i) -> f32 {
    let a = low - 1;
    let total = sum_to(high) - sum_to(vec3i(a.x, high.yz)) - sum_to(vec3i(high.x, a.y, high.z))
        - sum_to(vec3i(high.xy, a.z)) + sum_to(vec3i(a.xy, high.z)) + sum_to(vec3i(a.x, high.y, a.z))
        + sum_to(vec3i(high.x, a.yz)) - sum_to(a);
    return f32(total) / 1024.0;
}

// Cubes along the axis, each as wide as the cone.
fn summed_area_transparency(kind: u32, apex: vec3f, axis: vec3f, limit: f32) -> f32 {
    let end = min(limit, cones.kinds[kind].reach) / volume.voxel;
    let origin = texture_position(apex);
    let direction = texture_direction(axis) * volume.voxel;
    // voxels along each axis in one mean edge
    let scale = volume.size / volume.edges;
    var depth = 0.0;
    var d = cones.kinds[kind].starts.x;
    for (; d < end && depth < cones.kinds[kind].opaque;) {
        let width = max(2.0 * d * cones.kinds[kind].tangent, 1.0);
        let middle = (origin + (d + 0.5 * width) * direction) * volume.size;
        let half = max(0.5 * width * scale, vec3f(0.5));
        let low = vec3i(round(middle - half));
        let high = max(vec3i(round(middle + half)) - 1, low);
        let side = vec3f(high - low + 1);
        let outside = any(high < vec3i(0)) || any(vec3f(low) >= volume.size);
        let mean = box_sum(max(low, vec3i(0)), max(high, vec3i(0))) / (side.x * side.y * side.z);
        depth += select(mean * width, 0.0, outside) * cones.kinds[kind].attenuation;
        d += width;
    }
    return exp(-depth);
}

// Mean over the directions to a cube's faces and corners, of short rays.
fn local_openness(p: vec3f) -> f32 {
    let origin = texture_position(p);
    var sum = 0.0;
    for (var i = 0u; i < 14u; i++) {
        var toward = vec3f(vec3u(i & 1u, (i >> 1u) & 1u, (i >> 2u) & 1u)) * 2.0 - 1.0;
        if (i >= 8u) {
            let axis = (i - 8u) / 2u;
            let sign = f32(i & 1u) * 2.0 - 1.0;
            toward = sign * vec3f(vec3u(axis) == vec3u(0u, 1u, 2u));
        }
        let direction = texture_direction(normalize(toward)) * volume.voxel;
        var depth = 0.0;
        for (var d = cones.kinds[OCCLUSION_CONE].starts.x; d < LOCAL_RADIUS; d += 1.0) {
            let uvw = origin + d * direction;
            let inside = all(uvw == clamp(uvw, vec3f(0.0), vec3f(1.0)));
            depth += select(0.0, textureSampleLevel(pyramid, trilinear, uvw, 0.0).r, inside);
        }
        sum += exp(-depth * cones.kinds[OCCLUSION_CONE].attenuation);
    }
    return sum / 14.0;
}

fn transparency(kind: u32, apex: vec3f, axis: vec3f, limit: f32) -> f32 {
    if (METHOD == VOXEL_CONES) {
        return voxel_cone_transparency(kind, apex, axis, limit);
    }
    if (METHOD == SUMMED_AREA) {
        return summed_area_transparency(kind, apex, axis, limit);
    }
    if (METHOD == LOCAL_SPHERE && kind == OCCLUSION_CONE) {
        return local_openness(apex);
    }
    return cone_transparency(kind, apex, axis, limit);
}
