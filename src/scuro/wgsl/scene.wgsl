// What the tracer reads: primitives, grids, instances and objects. Filled by trace/accelerator.py.

// Which kinds of primitives the scene holds, and whether there is more than one instance or any
// clipping: constants, so that what a scene does not need is not compiled.
override HAS_RODS: bool = true;
override HAS_TRIANGLES: bool = true;
override HAS_TOP_LEVEL: bool = true;
override CLIPPED: bool = true;
// Whether any object has coarser levels of detail.
override HAS_LEVELS: bool = true;
// Whether some instances are whole assemblies, placed by frames.
override HAS_NESTING: bool = false;

//#include "instance_table.wgsl"

struct Instance {
    rotation: vec4f,
    // scene position of the geometry's local origin, which is the middle of its box
    center: vec3f,
    object: u32,
}

const UNCLIPPED: u32 = 1u;
// a surface without inside: nothing to cap
const OPEN: u32 = 2u;
// an assembly: its grid lists instances
const NESTED: u32 = 4u;

const NO_FRAME: u32 = 0xffffffffu;

// What tracing needs of an object.
struct Traced {
    grid: Grid,
    // of the bounding sphere around the local origin
    radius: f32,
    flags: u32,
    // the same at the next coarser level of detail, 0 for none
    coarser: u32,
    // median radius of its spheres
    detail: f32,
}

// What shading needs of an object.
struct Material {
    diffuse: f32,
    specular: f32,
    shininess: f32,
    opacity: f32,
    roughness: f32,
    ior: f32,
    // 0 diffuse, 1 glossy, 2 metal, 3 mirror, 4 glass
    kind: u32,
}

const MAX_PLANES: u32 = 32u;

struct Scene {
    // the grid over instances; with a single instance, that of its geometry
    top: Grid,
    // of a single instance
    rotation: vec4f,
    center: vec3f,
    planes: array<vec4f, MAX_PLANES>,
    plane_count: u32,
    // whether some object is not clipped
    spared: u32,
    // half the diagonal of the box around everything
    extent: f32,
    // median primitive radius: the scale of occlusion, penumbras and offsets
    primitive_radius: f32,
    // spheres may be merged up to a radius that grows with the distance from here
    eye: vec3f,
    detail_slope: f32,
    detail_floor: f32,
    // how instances are kept (trace/instances.py): steps of coordinates in the scene and in assemblies
    place_step: f32,
    inner_step: f32,
    object_bits: u32,
    radius_base: u32,
    radius_shift: u32,
    // how far beyond their bounding spheres they are listed
    reach: f32,
    // what is added to the number of an entry of `walked` to find its reference
    refs_from: u32,
    // of what a cell over instances lists, the first and the last object are told in so many bits each,
    // after a shift to the right
    span_bits: u32,
    span_shift: u32,
}

@group(1) @binding(0) var<uniform> scene: Scene;
// spheres: (center, radius); rods and cones: two slots; triangles: three (w unused)
@group(1) @binding(1) var slots: texture_2d<f32>;
// what rays walk through in geometries: all cells, then all entries (trace/copy.wgsl)
@group(1) @binding(2) var walked: texture_2d<u32>;
// all cells of grids over instances, then what they list, then the primitive of each entry of `walked`
@group(1) @binding(3) var refs: texture_2d<u32>;
// a texel or two for each instance (trace/instances.py)
@group(1) @binding(4) var instances: texture_2d<u32>;
// OBJECT_TEXELS an object
@group(1) @binding(5) var objects: texture_2d<u32>;

const OBJECT_TEXELS: u32 = 6u;

fn slot_at(index: u32) -> vec4f {
    return textureLoad(slots, table_place(index), 0);
}

// A cell (first entry, whether empty, bins of clear directions) or an entry: a sphere's bits, its
// radius negative if it is the last of its cell; or another primitive (primitive, whether last, 0, 0).
fn walked_at(index: u32) -> vec4u {
    return textureLoad(walked, table_place(index), 0);
}

// The primitive of an entry.
fn ref_at(entry: u32) -> u32 {
    return textureLoad(refs, table_place(entry + scene.refs_from), 0).x;
}

// A cell of a grid over instances (its first entry and the span of its objects, or NO_ENTRIES and bins
// of clear directions) or an entry (an instance, LAST_OF_CELL for the last of its cell).
fn listed_at(index: u32) -> u32 {
    return textureLoad(refs, table_place(index), 0).x;
}

// The first entry of a cell that is not empty.
fn first_listed(cell: u32) -> u32 {
    return cell & (0x7fffffffu >> (2u * scene.span_bits));
}

// Objects [x, y) among which all that such a cell lists is found.
fn listed_objects(cell: u32) -> vec2u {
    let bits = scene.span_bits;
    let span = vec2u(cell >> (31u - 2u * bits), cell >> (31u - bits)) & vec2u((1u << bits) - 1u);
    return (span + vec2u(0u, 1u)) << vec2u(scene.span_shift);
}

// The frame of the assembly through which a ray goes.
var<private> frame_at_hand: u32 = NO_FRAME;

fn place_at(index: u32, frame: u32) -> Standing {
    let step = select(scene.inner_step, scene.place_step, !HAS_NESTING || frame == NO_FRAME);
    return place_of(textureLoad(instances, table_place(place_index(index)), 0), step);
}

// The radius of the sphere in which all that an instance lists lies.
fn reach_of(place: Standing) -> f32 {
    return scene.reach
        + radius_of(place.tag, scene.object_bits, scene.radius_base, scene.radius_shift);
}

// An instance in the space of the scene, or of the assembly that stands in a frame.
fn instance_in(index: u32, frame: u32) -> Instance {
    let place = place_at(index, frame);
    let turn = turn_of(textureLoad(instances, table_place(turn_index(index)), 0));
    return Instance(turn, place.center, object_of(place.tag, scene.object_bits));
}

fn instance_at(index: u32) -> Instance {
    return instance_in(index, NO_FRAME);
}

fn traced_object(index: u32) -> Traced {
    let a = textureLoad(objects, table_place(OBJECT_TEXELS * index), 0);
    let b = textureLoad(objects, table_place(OBJECT_TEXELS * index + 1u), 0);
    let c = textureLoad(objects, table_place(OBJECT_TEXELS * index + 2u), 0);
    return Traced(
        Grid(bitcast<vec3f>(a.xyz), bitcast<f32>(a.w), b.xyz, b.w), bitcast<f32>(c.x), c.y, c.z,
        bitcast<f32>(c.w),
    );
}

fn material_at(index: u32) -> Material {
    let c = bitcast<vec4f>(textureLoad(objects, table_place(OBJECT_TEXELS * index + 3u), 0));
    let d = textureLoad(objects, table_place(OBJECT_TEXELS * index + 4u), 0);
    return Material(c.x, c.y, c.z, c.w, bitcast<f32>(d.x), bitcast<f32>(d.y), d.z);
}

// A point of the scene as an instance sees it.
fn in_frame(instance: Instance, p: vec3f) -> vec3f {
    return rotate(conjugate(instance.rotation), p - instance.center);
}

// An instance in the scene, through the frame of its assembly if it is in one.
fn placed(index: u32, frame: u32) -> Instance {
    let inner = instance_in(index, frame);
    if (!HAS_NESTING || frame == NO_FRAME) {
        return inner;
    }
    let outer = instance_at(frame);
    let center = outer.center + rotate(outer.rotation, inner.center);
    return Instance(multiplied(outer.rotation, inner.rotation), center, inner.object);
}

// How instances are numbered: object by object, and within it frame by frame.
struct Numbering {
    // number and row of its first instance
    number: u32,
    row: u32,
    // its instances in a frame, and the row of its first frame or NO_FRAME
    copies: u32,
    frame: u32,
}

fn numbering_of(object: u32) -> Numbering {
    let e = textureLoad(objects, table_place(OBJECT_TEXELS * object + 5u), 0);
    return Numbering(e.x, e.y, e.z, e.w);
}

// The number by which the G-buffer knows an instance.
fn leaf_number(index: u32, frame: u32, object: u32) -> u32 {
    if (!HAS_NESTING) {
        return index;
    }
    let numbers = numbering_of(object);
    let before = select((frame - numbers.frame) * numbers.copies, 0u, frame == NO_FRAME);
    return numbers.number + before + index - numbers.row;
}

// The instance of an object that has a number.
fn numbered(number: u32, object: u32) -> Instance {
    if (!HAS_NESTING) {
        return instance_at(number);
    }
    let numbers = numbering_of(object);
    let n = number - numbers.number;
    let frame = numbers.frame + n / max(numbers.copies, 1u);
    return placed(
        numbers.row + n % max(numbers.copies, 1u),
        select(frame, NO_FRAME, numbers.frame == NO_FRAME),
    );
}

// The rotation b, then a.
fn multiplied(a: vec4f, b: vec4f) -> vec4f {
    return vec4f(a.w * b.xyz + b.w * a.xyz + cross(a.xyz, b.xyz), a.w * b.w - dot(a.xyz, b.xyz));
}
