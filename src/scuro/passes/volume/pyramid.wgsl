// One level of the extinction pyramid (Campagnolo 2021, section 3.2.1): opacities, blurred by a
// Gaussian along x, y and z in turn, and turned back into extinction coefficients.
//
// Buffers hold half-floats in rows padded to 256 bytes, as copies into a texture want them. A pass
// works on a slab of planes, so that no buffer grows beyond what every device binds.

//#include "volume.wgsl"

struct Level {
    // voxels of the level that is read and of the one that is made
    source_size: vec3u,
    // voxels of the volume (or texels of the level above) along each side of one source voxel
    factor: u32,
    size: vec3u,
    // mip of the pyramid that is read
    source_mip: i32,
    // first plane of the slab that is read and that is made
    source_first: u32,
    first: u32,
    planes: u32,
    source_planes: u32,
    // extent of this pass's input and output, x in pairs: x becomes smaller first, then y, then z
    input: vec3u,
    axis: u32,
    output: vec3u,
    // whether the output is extinction instead of opacity
    last: u32,
    // deviation of the Gaussian and where it is cut, in voxels of the source
    sigma: f32,
    reach: f32,
}

@group(2) @binding(0) var<uniform> level: Level;
@group(2) @binding(1) var pyramid: texture_3d<f32>; // filterable
// 1 where the scene's surfaces fill space
@group(2) @binding(2) var solids: texture_3d<f32>; // filterable
@group(2) @binding(3) var<storage, read> from_: array<u32>;
@group(2) @binding(4) var<storage, read_write> to: array<u32>;
// opacity of one mean voxel edge, by table index
@group(2) @binding(5) var voxel_opacity: texture_2d<f32>;

const MOST: f32 = 0.999;

// words in a padded row of halves
fn row(width: u32) -> u32 {
    return ((width + 127u) / 128u) * 64u;
}

override HAS_CUTS: bool = false;
override HAS_SOLIDS: bool = false;
// whether texels of the first level stand for several voxels
override COARSE: bool = false;

fn voxel_opacity_at(at: vec3u) -> f32 {
    var opacity = textureLoad(
        voxel_opacity, vec2u(table_index(textureLoad(samples, at, 0).r), 0u), 0).x;
    let uvw = (vec3f(at) + 0.5) / volume.size;
    if (HAS_SOLIDS) {
        opacity = max(opacity, textureSampleLevel(solids, trilinear, uvw, 0.0).r);
    }
    if (HAS_CUTS) {
        let p = (volume.scene_from_texture * vec4f(uvw, 1.0)).xyz;
        opacity *= kept_share(p);
    }
    return opacity;
}

// Mean over the voxels that one texel of a coarser pyramid stands for.
fn texel_opacity(texel: vec3u) -> f32 {
    if (!COARSE) {
        return voxel_opacity_at(texel);
    }
    let low = texel * level.factor;
    let high = min(low + level.factor, vec3u(volume.size));
    var sum = 0.0;
    for (var z = low.z; z < high.z; z++) {
        for (var y = low.y; y < high.y; y++) {
            for (var x = low.x; x < high.x; x++) {
                sum += voxel_opacity_at(vec3u(x, y, z));
            }
        }
    }
    let count = high - low;
    return sum / f32(count.x * count.y * count.z);
}

// The slab's opacities from the volume, two texels a thread.
@compute @workgroup_size(64, 1, 1)
fn gather_volume(@builtin(global_invocation_id) id: vec3u) {
    let n = level.source_size;
    let left = vec3u(id.x * 2u, id.y, id.z + level.source_first);
    if (left.x >= n.x || id.y >= n.y || id.z >= level.source_planes) {
        return;
    }
    let right = vec3u(min(left.x + 1u, n.x - 1u), left.yz);
    to[(id.z * n.y + id.y) * row(n.x) + id.x] =
        pack2x16float(vec2f(texel_opacity(left), texel_opacity(right)));
}

// The slab's opacities from the level beneath.
@compute @workgroup_size(64, 1, 1)
fn gather_level(@builtin(global_invocation_id) id: vec3u) {
    let n = level.source_size;
    let left = vec3u(id.x * 2u, id.y, id.z + level.source_first);
    if (left.x >= n.x || id.y >= n.y || id.z >= level.source_planes) {
        return;
    }
    let right = vec3u(min(left.x + 1u, n.x - 1u), left.yz);
    let extinction = vec2f(textureLoad(pyramid, left, level.source_mip).r,
        textureLoad(pyramid, right, level.source_mip).r);
    to[(id.z * n.y + id.y) * row(n.x) + id.x] = pack2x16float(1.0 - exp(-extinction));
}

// Middle of an output voxel and the range of input voxels within reach, along one axis.
struct Window {
    middle: f32,
    low: i32,
    high: i32,
}

fn window(place: u32, count: u32, source_count: u32) -> Window {
    let middle = (f32(place) + 0.5) * f32(source_count) / f32(count) - 0.5;
    return Window(middle, max(i32(ceil(middle - level.reach)), 0),
        min(i32(floor(middle + level.reach)), i32(source_count) - 1));
}

// A Gaussian at equal steps needs no exponentials: the ratio of successive weights is itself
// multiplied by a constant. Weight at offset x, and its ratio to the one `step` farther.
fn weight_at(x: vec4f) -> vec4f {
    return exp(-0.5 * x * x / (level.sigma * level.sigma));
}

fn ratio_at(x: vec4f, step: f32) -> vec4f {
    return exp(-step * (x + 0.5 * step) / (level.sigma * level.sigma));
}

// Two neighbors a thread, which share what they read.
@compute @workgroup_size(64, 1, 1)
fn blur_x(@builtin(global_invocation_id) id: vec3u) {
    if (id.x * 2u >= level.size.x || id.y >= level.input.y || id.z >= level.input.z) {
        return;
    }
    let line = id.z * level.input.y + id.y;
    let base = line * row(level.source_size.x);
    let count = level.source_size.x;
    let a = window(id.x * 2u, level.size.x, count);
    let b = window(min(id.x * 2u + 1u, level.size.x - 1u), level.size.x, count);
    let first = u32(a.low) / 2u;
    let last = u32(b.high) / 2u;
    let start = f32(first * 2u);
    // (left half for a, right half for a, left for b, right for b)
    let x = vec4f(start, start + 1.0, start, start + 1.0) - vec2f(a.middle, b.middle).xxyy;
    var weight = weight_at(x);
    var ratio = ratio_at(x, 2.0);
    let change = exp(-4.0 / (level.sigma * level.sigma));
    var sum = vec2f(0.0);
    var total = vec2f(0.0);
    for (var i = first; i <= last; i++) {
        let pair = unpack2x16float(from_[base + i]);
        // rows of odd length end in half a pair
        let w = weight * vec2f(1.0, select(1.0, 0.0, i * 2u + 1u >= count)).xyxy;
        sum += w.xz * pair.x + w.yw * pair.y;
        total += w.xz + w.yw;
        weight *= ratio;
        ratio *= change;
    }
    to[line * row(level.size.x) + id.x] = pack2x16float(sum / total);
}

// Along y (axis 1) or z (axis 2), two neighbors in x a thread.
@compute @workgroup_size(64, 1, 1)
fn blur_yz(@builtin(global_invocation_id) id: vec3u) {
    if (id.x * 2u >= level.size.x || id.y >= level.output.y || id.z >= level.output.z) {
        return;
    }
    let words = row(level.size.x);
    var w: Window;
    var stride = words;
    var start: u32;
    if (level.axis == 1u) {
        w = window(id.y, level.size.y, level.source_size.y);
        start = id.z * level.input.y * words + id.x;
    } else {
        w = window(id.z + level.first, level.size.z, level.source_size.z);
        stride = level.input.y * words;
        start = id.y * words + id.x;
        // indices count from the slab's first plane
        w.middle -= f32(level.source_first);
        w.low -= i32(level.source_first);
        w.high -= i32(level.source_first);
    }
    let x = vec4f(f32(w.low) - w.middle);
    var weight = weight_at(x).x;
    var ratio = ratio_at(x, 1.0).x;
    let change = exp(-1.0 / (level.sigma * level.sigma));
    var sum = vec2f(0.0);
    var total = 0.0;
    for (var i = w.low; i <= w.high; i++) {
        sum += weight * unpack2x16float(from_[start + u32(i) * stride]);
        total += weight;
        weight *= ratio;
        ratio *= change;
    }
    let opacity = sum / total;
    let out = select(opacity, -log(1.0 - min(opacity, vec2f(MOST))), level.last != 0u);
    to[(id.z * level.output.y + id.y) * words + id.x] = pack2x16float(out);
}
