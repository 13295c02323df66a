// What the tracer reads: primitives, grids, instances and objects. Filled by trace/accelerator.py.

// Which kinds of primitives the scene holds, and whether there is more than one instance or any
// clipping: constants, so that what a scene does not need is not compiled.
override HAS_RODS: bool = true;
override HAS_TRIANGLES: bool = true;
override HAS_TOP_LEVEL: bool = true;
override CLIPPED: bool = true;

//#include "scene_types.wgsl"

// 32 bytes an instance
struct Instance {
    rotation: vec4f,
    // scene position of the geometry's local origin, which is the middle of its box
    center: vec3f,
    object: u32,
}

const UNCLIPPED: u32 = 1u;

struct Object {
    grid: Grid,
    // of the bounding sphere around the local origin
    radius: f32,
    flags: u32,
    diffuse: f32,
    specular: f32,
    shininess: f32,
    opacity: f32,
    roughness: f32,
    ior: f32,
    // 0 diffuse, 1 glossy, 2 metal, 3 mirror, 4 glass
    kind: u32,
    pad0: u32,
    pad1: u32,
    pad2: u32,
}

const MAX_PLANES: u32 = 32u;

struct Scene {
    top: Grid,
    planes: array<vec4f, MAX_PLANES>,
    plane_count: u32,
    // whether some object is not clipped
    spared: u32,
    instance_count: u32,
    // half the diagonal of the box around everything
    extent: f32,
    // median primitive radius: the scale of occlusion, penumbras and offsets
    primitive_radius: f32,
}

@group(1) @binding(0) var<uniform> scene: Scene;
// spheres: (center, radius); rods and cones: two slots; triangles: three (w unused)
@group(1) @binding(1) var<storage, read> slots: array<vec4f>;
@group(1) @binding(2) var<storage, read> cells: array<u32>;
@group(1) @binding(3) var<storage, read> refs: array<u32>;
@group(1) @binding(4) var<storage, read> instances: array<Instance>;
@group(1) @binding(5) var<storage, read> objects: array<Object>;

fn conjugate(q: vec4f) -> vec4f {
    return vec4f(-q.xyz, q.w);
}

fn rotate(q: vec4f, v: vec3f) -> vec3f {
    return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v);
}
