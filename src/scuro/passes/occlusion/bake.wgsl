// Baking visibility into patches: a texel of a patch is a point of an atom's or bond's surface.

//#include "fan_visibility.wgsl"
//#include "octahedral.wgsl"
//#include "sampling.wgsl"

struct Bake {
    // texels along the edge of a patch, without its border
    edge: u32,
    // patches in a row of the atlas
    columns: u32,
    patches: u32,
    // rays of a texel
    rays: u32,
    // texels of four neighbours a slot
    texels: u32,
    // first texel, or place in the list of open ones, of this dispatch, and how many
    offset: u32,
    count: u32,
}

@group(0) @binding(0) var<uniform> bake: Bake;
// primitive and instance of each patch
@group(0) @binding(1) var<storage, read> patches: array<vec2u>;
@group(0) @binding(2) var neighbours: texture_2d<u32>;
// points of the unit sphere, evenly spread
@group(0) @binding(3) var directions: texture_2d<f32>;
// visibility; -1 where a texel is buried
@group(0) @binding(4) var<storage, read_write> values: array<f32>;
// by object, what the rows of its slots in the table of neighbours are less than the slots
@group(0) @binding(6) var<storage, read> neighbours_skipped: array<u32>;
// how many texels are not buried, and which
@group(0) @binding(7) var<storage, read_write> open_texels: array<atomic<u32>>;
@group(0) @binding(5) var atlas: texture_storage_2d<r32float, write>;

struct Place {
    position: vec3f,
    normal: vec3f,
}

// Where texel (i, j) of a patch lies, in the instance's frame. Spheres unfold as octahedra; rods by
// height (i) and angle (j).
fn texel_place(primitive: u32, texel: vec2u) -> Place {
    let slot = slot_of(primitive);
    let a = slot_at(slot);
    let at = (vec2f(texel) + 0.5) / f32(bake.edge);
    if (kind_of(primitive) == SPHERE) {
        let n = octahedral_direction(at * 2.0 - 1.0);
        return Place(a.xyz + a.w * n, n);
    }
    let b = slot_at(slot + 1u);
    let frame = tangent_frame(normalize(b.xyz - a.xyz));
    let angle = 2.0 * PI * at.y;
    let n = frame[0] * cos(angle) + frame[1] * sin(angle);
    let middle = mix(a, b, at.x);
    return Place(middle.xyz + middle.w * n, n);
}

// How many caps a texel may be moved out of.
const RISES: u32 = 2u;

// Where on its sphere a buried texel would come to light, or where it is if it is not buried.
struct Risen {
    normal: vec3f,
    // whether that is far away, or not found
    buried: bool,
}

// Out of the caps that other spheres cut off, the deepest first. The caps' edges are creases: what is
// seen of them in between texels then comes from points beside them, and not from guesses.
fn risen(primitive: u32, normal: vec3f, object: u32) -> Risen {
    let slot = slot_of(primitive);
    let row = slot - neighbours_skipped[object];
    let own = slot_at(slot);
    var n = normal;
    var deepest = 0.0;
    for (var turn = 0u; turn <= RISES; turn += 1u) {
        var toward = vec3f(0.0);
        var edge = 0.0;
        deepest = 0.0;
        for (var i = 0u; i < 4u * bake.texels; i += 1u) {
            let four = textureLoad(neighbours, table_place(row * bake.texels + i / 4u), 0);
            let index = four[i % 4u];
            let other = slot_at(select(index, slot, index == NO_PRIMITIVE));
            let apart = other.xyz - own.xyz;
            let d = max(length(apart), 1e-6);
            // cosine of the cap's half angle
            let cap = (own.w * own.w + d * d - other.w * other.w) / (2.0 * own.w * d);
            let deep = dot(n, apart) / d - cap;
            if (index != NO_PRIMITIVE && deep > max(deepest, 1e-4)) {
                deepest = deep;
                toward = apart / d;
                edge = cap;
            }
        }
        if (deepest <= 0.0 || turn == RISES) {
            break;
        }
        // just beyond the edge, straight away from the cap's middle
        let beyond = 0.05 * PI / f32(bake.edge) * sqrt(max(1.0 - edge * edge, 0.0));
        let c = clamp(edge - max(1e-3, beyond), -1.0, 1.0);
        let across = n - dot(n, toward) * toward;
        n = c * toward + sqrt(1.0 - c * c) * normalize(across + 1e-7);
    }
    let far = acos(clamp(dot(n, normal), -1.0, 1.0)) > 2.5 * PI / f32(2u * bake.edge);
    return Risen(n, deepest > 0.0 || far);
}

// Whether a point is inside another sphere.
fn buried(primitive: u32, p: vec3f, object: u32) -> bool {
    let slot = slot_of(primitive);
    let row = slot - neighbours_skipped[object];
    var inside = false;
    for (var i = 0u; i < bake.texels; i += 1u) {
        let four = textureLoad(neighbours, table_place(row * bake.texels + i), 0);
        for (var j = 0u; j < 4u; j += 1u) {
            let sphere = slot_at(select(four[j], slot, four[j] == NO_PRIMITIVE));
            let apart = p - sphere.xyz;
            inside |= (four[j] != NO_PRIMITIVE) & (dot(apart, apart) < sphere.w * sphere.w * 0.9999);
        }
    }
    return inside;
}

// Where a texel's rays start, and whether none do.
fn seen_place(primitive: u32, texel: vec2u, object: u32, hidden: ptr<function, bool>) -> Place {
    var here = texel_place(primitive, texel);
    if (kind_of(primitive) == SPHERE) {
        let up = risen(primitive, here.normal, object);
        let own = slot_at(slot_of(primitive));
        here = Place(own.xyz + own.w * up.normal, up.normal);
        *hidden = up.buried;
    } else {
        *hidden = buried(primitive, here.position, object);
    }
    return here;
}

fn fan_direction(fan: Fan, index: u32) -> vec3f {
    return cosine_direction(fan.normal, textureLoad(directions, table_place(index), 0).xyz);
}

// A single texel stands for a whole atom: each ray has the point it leaves from.
fn mean_visibility(primitive: u32, instance: Instance) -> f32 {
    let a = slot_at(slot_of(primitive));
    let center = instance.center + rotate(instance.rotation, a.xyz);
    var open = 0.0;
    for (var i = 0u; i < bake.rays; i += 1u) {
        let w = textureLoad(directions, table_place(i), 0).xyz;
        let position = center + a.w * w;
        let origin = position + w * surface_offset(position, 0.0);
        open += select(1.0, 0.0, trace_any(Ray(origin, w), 0.0, NOTHING));
    }
    return open / f32(bake.rays);
}

fn texel_of(index: u32) -> vec2u {
    let within = index % (bake.edge * bake.edge);
    return vec2u(within % bake.edge, within / bake.edge);
}

// Texels that are not buried, listed so that no lane waits for those that are.
@compute @workgroup_size(64)
fn sift(@builtin(global_invocation_id) id: vec3u) {
    let index = bake.offset + id.x;
    if (id.x >= bake.count) {
        return;
    }
    let which = patches[index / (bake.edge * bake.edge)];
    var hidden = false;
    if (bake.edge > 1u) {
        _ = seen_place(which.x, texel_of(index), instance_at(which.y).object, &hidden);
    }
    if (hidden) {
        values[index] = -1.0;
    } else {
        atomicStore(&open_texels[1u + atomicAdd(&open_texels[0], 1u)], index);
    }
}

@compute @workgroup_size(64)
fn gather(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= bake.count) {
        return;
    }
    let index = atomicLoad(&open_texels[1u + bake.offset + id.x]);
    let which = patches[index / (bake.edge * bake.edge)];
    let instance = instance_at(which.y);
    if (bake.edge == 1u) {
        values[index] = mean_visibility(which.x, instance);
        return;
    }
    var hidden = false;
    let here = seen_place(which.x, texel_of(index), instance.object, &hidden);
    let normal = rotate(instance.rotation, here.normal);
    let position = instance.center + rotate(instance.rotation, here.position);
    let fan = fan_at(position + normal * surface_offset(position, 0.0), normal);
    values[index] = fan_visibility(fan, bake.rays, NOTHING);
}

fn value_at(index: u32, texel: vec2u) -> f32 {
    return values[index * bake.edge * bake.edge + texel.x + bake.edge * texel.y];
}

// A texel of the patch or just beside it: octahedra wrap over their edges, rods around the axis.
fn wrapped(primitive: u32, place: vec2i) -> vec2u {
    let last = i32(bake.edge) - 1;
    var p = place;
    if (kind_of(primitive) != SPHERE) {
        return vec2u(vec2i(clamp(p.x, 0, last), (p.y + last + 1) % (last + 1)));
    }
    if (p.x < 0 || p.x > last) {
        p = vec2i(clamp(p.x, 0, last), last - p.y);
    }
    if (p.y < 0 || p.y > last) {
        p = vec2i(last - p.x, clamp(p.y, 0, last));
    }
    return vec2u(clamp(p, vec2i(0), vec2i(last)));
}

// Fill the atlas, borders included; buried texels take the mean of their seen neighbours, so that
// interpolation at the circle where two atoms meet does not pick up black.
@compute @workgroup_size(64)
fn finish(@builtin(global_invocation_id) id: vec3u) {
    let index = bake.offset + id.x;
    let wide = bake.edge + 2u;
    let which = index / (wide * wide);
    if (which >= bake.patches) {
        return;
    }
    let within = vec2u(index % wide, (index / wide) % wide);
    let primitive = patches[which].x;
    let center = wrapped(primitive, vec2i(within) - 1);
    var value = value_at(which, center);
    if (value < 0.0) {
        var sum = 0.0;
        var total = 0.0;
        for (var reach = 1; reach <= 2; reach += 1) {
            for (var y = -reach; y <= reach; y += 1) {
                for (var x = -reach; x <= reach; x += 1) {
                    let near = value_at(which, wrapped(primitive, vec2i(center) + vec2i(x, y)));
                    let w = select(0.0, 1.0 / f32(reach * reach * reach), near >= 0.0);
                    sum += w * near;
                    total += w;
                }
            }
        }
        value = select(0.0, sum / max(total, 1e-9), total > 0.0);
    }
    let corner = vec2u(which % bake.columns, which / bake.columns) * wide;
    textureStore(atlas, corner + within, vec4f(value));
}
