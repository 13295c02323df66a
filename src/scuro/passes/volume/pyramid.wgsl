// One level of the extinction pyramid (Campagnolo 2021, section 3.2.1): opacities, blurred by a
// Gaussian along x, y and z in turn, and turned back into extinction coefficients.
//
// Buffers hold half-floats in rows padded to 256 bytes, as copies into a texture want them. A pass
// works on a slab of planes, so that no buffer grows beyond what every device binds.

//#include "volume.wgsl"

// distance, in sixteenths of a voxel, to which weights are tabulated
const WEIGHTS: u32 = 256u;

struct Level {
    // voxels of the level that is read and of the one that is made
    source_size: vec3u,
    // voxels of the volume (or texels of the level above) along each side of one source voxel
    factor: u32,
    size: vec3u,
    // mip of the pyramid that is read; -1 for the volume itself
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
    reach: f32,
    solids: u32,
    weights: array<vec4f, 64>,
}

@group(2) @binding(0) var<uniform> level: Level;
@group(2) @binding(1) var pyramid: texture_3d<f32>; // filterable
// 1 where the scene's surfaces fill space
@group(2) @binding(2) var solids: texture_3d<f32>; // filterable
@group(2) @binding(3) var<storage, read> from_: array<u32>;
@group(2) @binding(4) var<storage, read_write> to: array<u32>;

const MOST: f32 = 0.999;

// words in a padded row of halves
fn row(width: u32) -> u32 {
    return ((width + 127u) / 128u) * 64u;
}

fn opacity_of(voxel: vec3u) -> f32 {
    if (level.source_mip >= 0) {
        return 1.0 - exp(-textureLoad(pyramid, voxel, level.source_mip).r);
    }
    var sum = 0.0;
    let f = level.factor;
    let low = voxel * f;
    let high = min(low + f, vec3u(volume.size));
    for (var z = low.z; z < high.z; z++) {
        for (var y = low.y; y < high.y; y++) {
            for (var x = low.x; x < high.x; x++) {
                let at = vec3u(x, y, z);
                let uvw = (vec3f(at) + 0.5) / volume.size;
                var extinction = colors[table_index(textureLoad(samples, at, 0).r)].w;
                if (volume.cut_count > 0u && extinction > 0.0) {
                    if (is_cut((volume.scene_from_texture * vec4f(uvw, 1.0)).xyz)) {
                        extinction = 0.0;
                    }
                }
                var opacity = 1.0 - exp(-extinction);
                if (level.solids != 0u) {
                    opacity = max(opacity, textureSampleLevel(solids, trilinear, uvw, 0.0).r);
                }
                sum += opacity;
            }
        }
    }
    let count = high - low;
    return sum / f32(count.x * count.y * count.z);
}

// The slab's opacities, two voxels a thread.
@compute @workgroup_size(64, 1, 1)
fn gather(@builtin(global_invocation_id) id: vec3u) {
    let n = level.source_size;
    let x = id.x * 2u;
    if (x >= n.x || id.y >= n.y || id.z >= level.source_planes) {
        return;
    }
    let z = id.z + level.source_first;
    let a = opacity_of(vec3u(x, id.y, z));
    var b = 0.0;
    if (x + 1u < n.x) {
        b = opacity_of(vec3u(x + 1u, id.y, z));
    }
    to[(id.z * n.y + id.y) * row(n.x) + id.x] = pack2x16float(vec2f(a, b));
}

fn weight_of(distance: f32) -> f32 {
    let i = u32(abs(distance) * 16.0 + 0.5);
    return level.weights[i / 4u][i % 4u];
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

fn blurred_x(x: u32, base: u32) -> f32 {
    let w = window(x, level.size.x, level.source_size.x);
    var sum = 0.0;
    var total = 0.0;
    for (var i = w.low; i <= w.high; i++) {
        let pair = unpack2x16float(from_[base + u32(i) / 2u]);
        let weight = weight_of(f32(i) - w.middle);
        sum += weight * select(pair.x, pair.y, (i & 1) == 1);
        total += weight;
    }
    return sum / total;
}

@compute @workgroup_size(64, 1, 1)
fn blur_x(@builtin(global_invocation_id) id: vec3u) {
    if (id.x * 2u >= level.size.x || id.y >= level.input.y || id.z >= level.input.z) {
        return;
    }
    let line = id.z * level.input.y + id.y;
    let base = line * row(level.source_size.x);
    let a = blurred_x(id.x * 2u, base);
    let b = blurred_x(min(id.x * 2u + 1u, level.size.x - 1u), base);
    to[line * row(level.size.x) + id.x] = pack2x16float(vec2f(a, b));
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
    var sum = vec2f(0.0);
    var total = 0.0;
    for (var i = w.low; i <= w.high; i++) {
        let weight = weight_of(f32(i) - w.middle);
        sum += weight * unpack2x16float(from_[start + u32(i) * stride]);
        total += weight;
    }
    var out = sum / total;
    if (level.last != 0u) {
        out = -log(1.0 - min(out, vec2f(MOST)));
    }
    to[(id.z * level.output.y + id.y) * words + id.x] = pack2x16float(out);
}
