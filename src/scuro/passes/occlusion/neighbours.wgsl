// The nearest spheres of each sphere and rod end, by the distance between centers.
//
// Sixteen at a time, or 24, are kept in order in registers: a sphere is put in its place among them by
// comparisons alone, without a branch. Longer lists go on behind the last of those before.

//#include "scene_types.wgsl"

// Whether 24 are kept at a time.
override WIDE: bool = false;

struct Search {
    // queries of this dispatch: the first, and the end
    first: u32,
    end: u32,
    // how many of the geometry's queries are spheres; the others are rod ends
    spheres: u32,
    // its first sphere in `entries`, its first rod end in `slots`, its first cell in `starts`
    entries: u32,
    rods: u32,
    cells: u32,
    // row of a slot in `found` is less than it by so much
    skipped: u32,
    texels: u32,
    origin: vec3f,
    cell: f32,
    dims: vec3i,
}

@group(0) @binding(0) var<uniform> search: Search;
@group(0) @binding(1) var slots: texture_2d<f32>;
// spheres sorted by cells: the bits of a center, and its slot
@group(0) @binding(2) var entries: texture_2d<u32>;
// of each cell its first entry; one more at the end
@group(0) @binding(3) var starts: texture_2d<u32>;
@group(0) @binding(4) var found: texture_storage_2d<rgba32uint, write>;

const FAR: f32 = 3e38;
// cells each way that are searched first: spheres are about as far apart as cells are large
const FIRST_REACH: i32 = 2;
// and at most: what is so many spheres away blocks less than a thousandth (lavapipe also ends loops
// silently after 65,535 turns)
const LAST_REACH: i32 = 12;

// Squares of distances, ascending, and whose they are.
struct Nearest {
    a: vec4f,
    b: vec4f,
    c: vec4f,
    d: vec4f,
    e: vec4f,
    f: vec4f,
    ia: vec4u,
    ib: vec4u,
    ic: vec4u,
    id: vec4u,
    ie: vec4u,
    ig: vec4u,
}

fn no_neighbours() -> Nearest {
    let far = vec4f(FAR);
    let none = vec4u(NO_PRIMITIVE);
    return Nearest(far, far, far, far, far, far, none, none, none, none, none, none);
}

// The last of the first 4, 8 ... that are kept.
fn last_of(n: ptr<function, Nearest>, texels: u32) -> f32 {
    return array<f32, 6>((*n).a.w, (*n).b.w, (*n).c.w, (*n).d.w, (*n).e.w, (*n).f.w)[texels - 1u];
}

// Four in order among which x belongs, given the one before them.
fn shifted(x: f32, before: vec4f, four: vec4f) -> vec4f {
    return max(before, min(vec4f(x), four));
}

fn shifted_slots(x: f32, slot: u32, before: vec4f, islots: vec4u, four: vec4f, slots: vec4u) -> vec4u {
    let here = select(vec4u(slot), islots, vec4f(x) < before);
    return select(slots, here, vec4f(x) < four);
}

fn insert(n: ptr<function, Nearest>, x: f32, slot: u32) {
    let a = (*n).a;
    let b = (*n).b;
    let c = (*n).c;
    let d = (*n).d;
    let ia = (*n).ia;
    let ib = (*n).ib;
    let ic = (*n).ic;
    let before_a = vec4f(-1.0, a.xyz);
    let before_b = vec4f(a.w, b.xyz);
    let before_c = vec4f(b.w, c.xyz);
    let before_d = vec4f(c.w, d.xyz);
    if (WIDE) {
        let e = (*n).e;
        let f = (*n).f;
        let before_e = vec4f(d.w, e.xyz);
        let before_f = vec4f(e.w, f.xyz);
        (*n).ig = shifted_slots(x, slot, before_f, vec4u((*n).ie.w, (*n).ig.xyz), f, (*n).ig);
        (*n).ie = shifted_slots(x, slot, before_e, vec4u((*n).id.w, (*n).ie.xyz), e, (*n).ie);
        (*n).f = shifted(x, before_f, f);
        (*n).e = shifted(x, before_e, e);
    }
    (*n).id = shifted_slots(x, slot, before_d, vec4u(ic.w, (*n).id.xyz), d, (*n).id);
    (*n).ic = shifted_slots(x, slot, before_c, vec4u(ib.w, ic.xyz), c, ic);
    (*n).ib = shifted_slots(x, slot, before_b, vec4u(ia.w, ib.xyz), b, ib);
    (*n).ia = shifted_slots(x, slot, before_a, vec4u(0u, ia.xyz), a, ia);
    (*n).a = shifted(x, before_a, a);
    (*n).b = shifted(x, before_b, b);
    (*n).c = shifted(x, before_c, c);
    (*n).d = shifted(x, before_d, d);
}

fn start_of(cell: i32) -> u32 {
    return textureLoad(starts, table_place(search.cells + u32(cell)), 0).x;
}

// Look at the cells from x to y of one row along x. What is no farther than `behind` was found before.
fn look(
    n: ptr<function, Nearest>, p: vec3f, own: u32, row: i32, xs: vec2i, behind: f32,
) {
    let low = max(xs.x, 0);
    let high = min(xs.y, search.dims.x - 1);
    var entry = 0u;
    var end = 0u;
    if (low <= high) {
        entry = start_of(row + low);
        end = start_of(row + high + 1);
    }
    while (entry < end) {
        let texel = textureLoad(entries, table_place(entry), 0);
        let apart = bitcast<vec3f>(texel.xyz) - p;
        let square = dot(apart, apart);
        // equally far ones are told apart by the lowest bits
        let key = bitcast<f32>((bitcast<u32>(square) & 0xffffff00u) | (texel.w & 0xffu));
        insert(n, select(FAR, key, key > behind && texel.w != own), texel.w);
        entry += 1u;
    }
}

// All cells that are `reach` away from one, or as near if it is the first time.
fn look_around(
    n: ptr<function, Nearest>, p: vec3f, own: u32, center: vec3i, reach: i32, behind: f32,
) {
    let low = max(center - reach, vec3i(0)).yz;
    let high = min(center + reach, search.dims - 1).yz;
    for (var z = low.y; z <= high.y; z += 1) {
        for (var y = low.x; y <= high.x; y += 1) {
            let dy = y - center.y;
            let dz = z - center.z;
            let row = search.dims.x * (y + search.dims.y * z);
            if (reach == FIRST_REACH || max(abs(dy), abs(dz)) == reach) {
                look(n, p, own, row, vec2i(center.x - reach, center.x + reach), behind);
            } else {
                look(n, p, own, row, vec2i(center.x - reach), behind);
                look(n, p, own, row, vec2i(center.x + reach), behind);
            }
        }
    }
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let query = search.first + id.x;
    if (query >= search.end) {
        return;
    }
    var p: vec3f;
    var own: u32;
    if (query < search.spheres) {
        let texel = textureLoad(entries, table_place(search.entries + query), 0);
        p = bitcast<vec3f>(texel.xyz);
        own = texel.w;
    } else {
        own = search.rods + query - search.spheres;
        p = textureLoad(slots, table_place(own), 0).xyz;
    }
    let place = (p - search.origin) / search.cell;
    let center = vec3i(floor(place));
    let inner = place - floor(place);
    let edge = min(min(inner.x, 1.0 - inner.x), min(min(inner.y, 1.0 - inner.y), min(inner.z, 1.0 - inner.z)));
    let whole = max(max(center, search.dims - 1 - center), vec3i(0));
    let farthest = min(LAST_REACH, max(whole.x, max(whole.y, whole.z)));
    var behind = -1.0;
    let width = select(4u, 6u, WIDE);
    for (var texel = 0u; texel < search.texels; texel += width) {
        let asked = min(search.texels - texel, width);
        var n = no_neighbours();
        var reach = FIRST_REACH;
        loop {
            look_around(&n, p, own, center, reach, behind);
            // what lies in cells beyond is farther than this
            let sure = search.cell * (f32(reach) + edge);
            if (last_of(&n, asked) <= sure * sure || reach >= farthest) {
                break;
            }
            reach += 1;
        }
        let lists = array<vec4u, 6>(n.ia, n.ib, n.ic, n.id, n.ie, n.ig);
        for (var i = 0u; i < asked; i += 1u) {
            let index = (own - search.skipped) * search.texels + texel + i;
            textureStore(found, table_place(index), lists[i]);
        }
        behind = last_of(&n, width);
    }
}
