// Baking visibility into patches: a texel of a patch is a point of an atom's or bond's surface.

//#include "trace.wgsl"
//#include "octahedral.wgsl"
//#include "sampling.wgsl"

struct Bake {
    // texels along the edge of a patch, without its border
    edge: u32,
    // patches in a row of the atlas
    columns: u32,
    patches: u32,
    // directions of this slice, and of all
    first: u32,
    count: u32,
    directions: u32,
    // texels of four neighbours a slot
    texels: u32,
    // first texel of this dispatch
    offset: u32,
}

@group(0) @binding(0) var<uniform> bake: Bake;
// primitive and instance of each patch
@group(0) @binding(1) var<storage, read> patches: array<vec2u>;
@group(0) @binding(2) var neighbours: texture_2d<u32>;
// one of each pair of opposite directions
@group(0) @binding(3) var directions: texture_2d<f32>;
// weighted visibility and weight; a negative weight marks a buried texel
@group(0) @binding(4) var<storage, read_write> sums: array<vec2f>;
// by object, what the rows of its slots in the table of neighbours are less than the slots
@group(0) @binding(6) var<storage, read> neighbours_skipped: array<u32>;
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

@compute @workgroup_size(64)
fn gather(@builtin(global_invocation_id) id: vec3u) {
    let index = bake.offset + id.x;
    let area = bake.edge * bake.edge;
    if (index >= bake.patches * area) {
        return;
    }
    let which = patches[index / area];
    let texel = vec2u((index % area) % bake.edge, (index % area) / bake.edge);
    let here = texel_place(which.x, texel);
    let instance = instance_at(which.y);
    var sum = sums[index];
    if (bake.first == 0u && bake.edge > 1u && buried(which.x, here.position, instance.object)) {
        sum.y = -1.0;
    }
    if (sum.y < 0.0) {
        sums[index] = sum;
        return;
    }
    for (var i = 0u; i < bake.count; i += 1u) {
        var w = textureLoad(directions, table_place(bake.first + i), 0).xyz;
        var normal = rotate(instance.rotation, here.normal);
        if (bake.edge == 1u) {
            // a single texel stands for the whole atom: each direction has the point it leaves from
            normal = w;
        }
        let facing = dot(normal, w);
        w *= select(-1.0, 1.0, facing >= 0.0);
        var local = here.position;
        if (bake.edge == 1u) {
            let a = slot_at(slot_of(which.x));
            local = a.xyz + a.w * rotate(conjugate(instance.rotation), w);
        }
        let position = instance.center + rotate(instance.rotation, local);
        let origin = position + normal * surface_offset(position, 0.0);
        let open = select(1.0, 0.0, trace_any(Ray(origin, w), 0.0, NOTHING));
        sum += vec2f(open, 1.0) * abs(facing);
    }
    sums[index] = sum;
}

fn value_at(index: u32, texel: vec2u) -> f32 {
    let sum = sums[index * bake.edge * bake.edge + texel.x + bake.edge * texel.y];
    return select(-1.0, sum.x / max(sum.y, 1e-9), sum.y > 0.0);
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
