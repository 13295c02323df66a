// Sorting primitives, or instances, into the cells of their grids: count, then (after a prefix sum)
// fill, then sort. One thread an item in `count` and `fill`, one a cell in `finish`. Sorting makes the
// lists, and with them every picture, independent of the order in which threads ran.

//#include "instance_table.wgsl"
//#include "octahedral.wgsl"

struct Build {
    // threads of this dispatch
    count: u32,
    // its first instance or cell
    first: u32,
    // the grid of its instances
    grid: u32,
    // number of the entry that the first reference is of
    base: u32,
    // radii r of solids count as factor r + margin; triangles are not solid
    factor: f32,
    margin: f32,
    // how far beyond their surfaces instances are listed
    reach: f32,
    // texels along the edge of an object's table in `supports`
    support_edge: u32,
    // how instances are kept
    place_step: f32,
    object_bits: u32,
    radius_base: u32,
    radius_shift: u32,
    // how cells tell the objects that they list: wgsl/scene.wgsl
    span_bits: u32,
    span_shift: u32,
}

@group(0) @binding(0) var<uniform> build: Build;
// a primitive (kind and slot) and the number of its grid
@group(0) @binding(1) var<storage, read> items: array<vec2u>;
@group(0) @binding(2) var<storage, read> grids: array<Grid>;
@group(0) @binding(3) var slots: texture_2d<f32>;
@group(0) @binding(4) var instances: texture_2d<u32>;
@group(0) @binding(5) var<storage, read_write> counts: array<atomic<u32>>;
@group(0) @binding(6) var<storage, read_write> cells: array<u32>;
@group(0) @binding(7) var<storage, read_write> refs: array<u32>;
// how far each object reaches in each direction of its own frame (trace/support.py)
@group(0) @binding(8) var<storage, read> supports: array<f32>;

fn slot_at(index: u32) -> vec4f {
    return textureLoad(slots, table_place(index), 0);
}

// The solid of an item, as the pieces that the cell test needs.
struct Extent {
    low: vec3f,
    high: vec3f,
    a: vec3f,
    b: vec3f,
    radius: f32,
    // plane of a triangle; zero for the others
    plane: vec4f,
}

fn extent_of(primitive: u32) -> Extent {
    var e: Extent;
    let slot = slot_of(primitive);
    let first = slot_at(slot);
    e.a = first.xyz;
    e.b = e.a;
    e.radius = first.w * build.factor + build.margin;
    let kind = kind_of(primitive);
    if (kind == TRIANGLE) {
        e.b = slot_at(slot + 1u).xyz;
        let c = slot_at(slot + 2u).xyz;
        let normal = cross(e.b - e.a, c - e.a);
        e.radius = 0.0;
        e.plane = vec4f(normal, -dot(normal, e.a));
        e.low = min(e.a, min(e.b, c));
        e.high = max(e.a, max(e.b, c));
        return e;
    }
    if (kind != SPHERE) {
        let second = slot_at(slot + 1u);
        e.b = second.xyz;
        e.radius = max(first.w, second.w) * build.factor + build.margin;
    }
    e.low = min(e.a, e.b) - e.radius;
    e.high = max(e.a, e.b) + e.radius;
    return e;
}

// Whether the solid may touch a cell: exact for spheres, a little generous for the others.
fn touches(e: Extent, low: vec3f, size: f32) -> bool {
    let center = low + 0.5 * size;
    if (any(e.plane != vec4f(0.0))) {
        let reach = 0.5 * size * (abs(e.plane.x) + abs(e.plane.y) + abs(e.plane.z));
        return abs(dot(e.plane.xyz, center) + e.plane.w) <= reach * 1.001 + 1e-12;
    }
    let axis = e.b - e.a;
    let length2 = dot(axis, axis);
    if (length2 > 0.0) {
        let h = saturate(dot(center - e.a, axis) / length2);
        return distance(center, e.a + h * axis) <= e.radius + 0.8661 * size;
    }
    let off = max(abs(e.a - center) - 0.5 * size, vec3f(0.0));
    return dot(off, off) <= e.radius * e.radius * 1.0001;
}

struct Range {
    low: vec3i,
    high: vec3i,
}

fn cell_range(e: Extent, grid: Grid) -> Range {
    let last = vec3i(grid.dims) - 1;
    // a sliver more than needed: rounding must not lose a cell that a ray visits
    let sliver = 1e-4 * grid.cell;
    return Range(
        clamp(vec3i(floor((e.low - sliver - grid.origin) / grid.cell)), vec3i(0), last),
        clamp(vec3i(floor((e.high + sliver - grid.origin) / grid.cell)), vec3i(0), last),
    );
}

fn cell_number(grid: Grid, cell: vec3i) -> u32 {
    let c = vec3u(cell);
    return grid.cells + c.x + grid.dims.x * (c.y + grid.dims.y * c.z);
}

// Count an item in a cell, or write it there.
fn put(item: u32, cell: u32, filling: bool) {
    let place = atomicAdd(&counts[cell], 1u);
    if (filling) {
        refs[cells[cell] - build.base + place] = item;
    }
}

// The same in all cells that a solid may touch.
fn visit(item: u32, extent: Extent, grid: Grid, filling: bool) {
    let range = cell_range(extent, grid);
    for (var z = range.low.z; z <= range.high.z; z += 1) {
        for (var y = range.low.y; y <= range.high.y; y += 1) {
            for (var x = range.low.x; x <= range.high.x; x += 1) {
                let low = grid.origin + vec3f(vec3i(x, y, z)) * grid.cell;
                if (!touches(extent, low, grid.cell)) {
                    continue;
                }
                put(item, cell_number(grid, vec3i(x, y, z)), filling);
            }
        }
    }
}

fn visit_primitive(index: u32, filling: bool) {
    if (index < build.count) {
        let item = items[index];
        visit(item.x, extent_of(item.x), grids[item.y], filling);
    }
}

fn visit_instance(index: u32, filling: bool) {
    let row = build.first + index;
    let texel = textureLoad(instances, table_place(place_index(row)), 0);
    let place = place_of(texel, build.place_step);
    let radius = radius_of(place.tag, build.object_bits, build.radius_base, build.radius_shift);
    if (index >= build.count || radius == 0.0) {
        return;
    }
    let object = object_of(place.tag, build.object_bits);
    let turn = conjugate(turn_of(textureLoad(instances, table_place(turn_index(row)), 0)));
    var e: Extent;
    e.a = place.center;
    e.radius = radius + build.reach;
    e.low = e.a - e.radius;
    e.high = e.a + e.radius;
    let grid = grids[build.grid];
    let sliver = 1e-4 * (grid.cell + e.radius);
    let range = cell_range(e, grid);
    for (var z = range.low.z; z <= range.high.z; z += 1) {
        for (var y = range.low.y; y <= range.high.y; y += 1) {
            for (var x = range.low.x; x <= range.high.x; x += 1) {
                let low = grid.origin + vec3f(vec3i(x, y, z)) * grid.cell - e.a;
                // the cell lies beyond a plane through its nearest point, across the way there
                let off = clamp(vec3f(0.0), low, low + grid.cell);
                let away = length(off);
                if (away > e.radius + sliver) {
                    continue;
                }
                if (away <= support_of(object, rotate(turn, off)) + build.reach + sliver) {
                    put(row, cell_number(grid, vec3i(x, y, z)), filling);
                }
            }
        }
    }
}

// How far an object reaches in a direction of its own frame, at least.
fn support_of(object: u32, direction: vec3f) -> f32 {
    let edge = build.support_edge;
    let square = octahedral_square(select(direction, vec3f(0.0, 0.0, 1.0), all(direction == vec3f(0.0))));
    let texel = min(vec2u((0.5 * square + 0.5) * f32(edge)), vec2u(edge - 1u));
    return supports[(object * edge + texel.y) * edge + texel.x];
}

@compute @workgroup_size(64)
fn count_primitives(@builtin(global_invocation_id) id: vec3u) {
    visit_primitive(id.x, false);
}

// `cells` holds the prefix sum and `counts` is zero again
@compute @workgroup_size(64)
fn fill_primitives(@builtin(global_invocation_id) id: vec3u) {
    visit_primitive(id.x, true);
}

@compute @workgroup_size(64)
fn count_instances(@builtin(global_invocation_id) id: vec3u) {
    visit_instance(id.x, false);
}

@compute @workgroup_size(64)
fn fill_instances(@builtin(global_invocation_id) id: vec3u) {
    visit_instance(id.x, true);
}

@compute @workgroup_size(64)
fn finish(@builtin(global_invocation_id) id: vec3u) {
    let cell = build.first + id.x;
    if (id.x >= build.count) {
        return;
    }
    let length = atomicLoad(&counts[cell]);
    if (length == 0u) {
        return;
    }
    let first = cells[cell] - build.base;
    for (var i = first + 1u; i < first + length; i += 1u) {
        let moving = refs[i];
        var j = i;
        while (j > first && refs[j - 1u] > moving) {
            refs[j] = refs[j - 1u];
            j -= 1u;
        }
        refs[j] = moving;
    }
    refs[first + length - 1u] |= LAST_OF_CELL;
}

fn listed_object(row: u32) -> u32 {
    let texel = textureLoad(instances, table_place(place_index(row)), 0);
    return object_of(place_of(texel, build.place_step).tag, build.object_bits);
}

// Tell the span of objects that a cell over instances lists, above the number of its first entry.
@compute @workgroup_size(64)
fn span_objects(@builtin(global_invocation_id) id: vec3u) {
    let cell = build.first + id.x;
    if (id.x >= build.count || (refs[cell] & NO_ENTRIES) != 0u) {
        return;
    }
    // sorted by instance, entries are sorted by object as well
    let index = refs[cell];
    var end = index;
    while ((refs[end] & LAST_OF_CELL) == 0u) {
        end += 1u;
    }
    let first = listed_object(refs[index] & ~LAST_OF_CELL);
    let last = listed_object(refs[end] & ~LAST_OF_CELL);
    let span = (last >> build.span_shift << build.span_bits) | (first >> build.span_shift);
    refs[cell] |= span << (31u - 2u * build.span_bits);
}
