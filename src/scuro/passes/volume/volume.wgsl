// A scalar volume as the passes see it: where it lies, its samples, its transfer function, and
// which blocks of it are empty. Filled by passes/volume/grid.py and classify.py.

//#include "ray.wgsl"

const MAX_CUTS: u32 = 32u;

struct Volume {
    // texture coordinates, 0 to 1, of a scene position
    texture_from_scene: mat4x4f,
    scene_from_texture: mat4x4f,
    // voxels along x, y, z
    size: vec3f,
    // mean edge of a voxel in scene units: the length that opacities are given for
    voxel: f32,
    // blocks along x, y, z
    blocks: vec3u,
    // distance between samples, scene units
    step: f32,
    // half-spaces that are kept: normal . p + offset >= 0, scene space
    cuts: array<vec4f, MAX_CUTS>,
    cut_count: u32,
    // last index of the tables
    table_end: f32,
    // lengths of the whole volume's edges in mean voxel edges
    edges: vec3f,
}

// edge of a block in voxels
const BLOCK: f32 = 4.0;

@group(1) @binding(0) var<uniform> volume: Volume;
// samples, normalised so that the tables span 0 to 1
@group(1) @binding(1) var samples: texture_3d<f32>; // filterable
@group(1) @binding(2) var trilinear: sampler;
// linear color, and extinction coefficient per mean voxel edge, at equal steps of the value
@group(1) @binding(3) var colors: texture_2d<f32>;
// integral of extinction from the first entry, in two parts; extinction; integral of extinction
// times the entry's number
@group(1) @binding(4) var integrals: texture_2d<f32>;
// for each block: blocks to the nearest that is not empty (Chebyshev distance), 0 where occupied
@group(1) @binding(5) var<storage, read> distances: array<u32>;

// as `trilinear`, but without filtering where values are labels
@group(1) @binding(8) var value_sampler: sampler;

fn texture_position(p: vec3f) -> vec3f {
    return (volume.texture_from_scene * vec4f(p, 1.0)).xyz;
}

fn texture_direction(d: vec3f) -> vec3f {
    return (volume.texture_from_scene * vec4f(d, 0.0)).xyz;
}

fn value_at(uvw: vec3f) -> f32 {
    return textureSampleLevel(samples, value_sampler, uvw, 0.0).r;
}

fn table_index(value: f32) -> u32 {
    return u32(clamp(value, 0.0, 1.0) * volume.table_end + 0.5);
}

fn color_at(index: u32) -> vec4f {
    return textureLoad(colors, vec2u(index, 0u), 0);
}

// Extinction coefficient per mean voxel edge at a point of the medium; nothing outside.
fn extinction_at(uvw: vec3f) -> f32 {
    if (any(uvw < vec3f(0.0)) || any(uvw > vec3f(1.0))) {
        return 0.0;
    }
    return color_at(table_index(value_at(uvw))).w;
}

fn smooth_value(uvw: vec3f) -> f32 {
    return textureSampleLevel(samples, trilinear, uvw, 0.0).r;
}

// Gradient of the normalised values in scene space, by central differences one voxel wide.
fn gradient_at(uvw: vec3f) -> vec3f {
    let h = 0.5 / volume.size;
    let g = vec3f(
        smooth_value(uvw + vec3f(h.x, 0.0, 0.0)) - smooth_value(uvw - vec3f(h.x, 0.0, 0.0)),
        smooth_value(uvw + vec3f(0.0, h.y, 0.0)) - smooth_value(uvw - vec3f(0.0, h.y, 0.0)),
        smooth_value(uvw + vec3f(0.0, 0.0, h.z)) - smooth_value(uvw - vec3f(0.0, 0.0, h.z)),
    ) * volume.size;
    // covariant: by the transpose of the map that takes scene to texture
    return (transpose(volume.texture_from_scene) * vec4f(g, 0.0)).xyz;
}

// Share of a voxel about a point that all cuts keep: 0 or 1 would show oblique cuts as stairs.
fn kept_share(p: vec3f) -> f32 {
    var share = 1.0;
    for (var i = 0u; i < volume.cut_count + (i >> 31u); i++) {
        let height = dot(volume.cuts[i].xyz, p) + volume.cuts[i].w;
        share *= clamp(height / volume.voxel + 0.5, 0.0, 1.0);
    }
    return share;
}

struct Crossing {
    near: f32,
    far: f32,
    // the cut that the ray enters by, or cut_count
    cut: u32,
}

// Where a ray is inside the volume's box and all cuts; near > far when nowhere.
fn crossing(ray: Ray) -> Crossing {
    let o = texture_position(ray.origin);
    let d = texture_direction(ray.direction);
    // parallel to a pair of faces: a huge slope keeps the signs and makes no NaN
    let inverse = 1.0 / select(d, vec3f(1e-20), abs(d) < vec3f(1e-20));
    let a = -o * inverse;
    let b = (1.0 - o) * inverse;
    let lower = min(a, b);
    let upper = max(a, b);
    var out = Crossing(
        max(max(lower.x, lower.y), max(lower.z, 0.0)),
        min(upper.x, min(upper.y, upper.z)),
        volume.cut_count,
    );
    for (var i = 0u; i < volume.cut_count + (i >> 31u); i++) {
        let height = dot(volume.cuts[i].xyz, ray.origin) + volume.cuts[i].w;
        let slope = dot(volume.cuts[i].xyz, ray.direction);
        if (abs(slope) < 1e-12) {
            if (height < 0.0) {
                out.far = -1.0;
            }
        } else {
            let t = -height / slope;
            if (slope > 0.0 && t > out.near) {
                out.near = t;
                out.cut = i;
            } else if (slope < 0.0) {
                out.far = min(out.far, t);
            }
        }
    }
    return out;
}

fn block_index(at: vec3f) -> vec3i {
    return clamp(vec3i(at / BLOCK), vec3i(0), vec3i(volume.blocks) - 1);
}

fn block_distance(block: vec3i) -> u32 {
    let n = vec3i(volume.blocks);
    return distances[(block.z * n.y + block.y) * n.x + block.x];
}

// Distance that a ray can go from a point (voxels from the box's corner) without meeting anything,
// given the inverse of its direction in voxels; 0 where the block is occupied.
fn empty_length(at: vec3f, inverse: vec3f) -> f32 {
    let block = block_index(at);
    let free = block_distance(block);
    if (free == 0u) {
        return 0.0;
    }
    let low = vec3f(block - i32(free) + 1) * BLOCK;
    let high = vec3f(block + i32(free)) * BLOCK;
    let exits = (select(high, low, inverse < vec3f(0.0)) - at) * inverse;
    return max(min(exits.x, min(exits.y, exits.z)), 0.0);
}
