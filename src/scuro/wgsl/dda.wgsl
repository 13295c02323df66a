// Walking a ray through the cells of a grid (Amanatides & Woo 1987).

//#include "ray.wgsl"
//#include "scene.wgsl"

// One over each component; a zero becomes huge, so that no NaN arises in slab tests.
fn safe_inverse(d: vec3f) -> vec3f {
    let tiny = vec3f(1e-20);
    return 1.0 / select(d, select(-tiny, tiny, d >= vec3f(0.0)), abs(d) < tiny);
}

// State of a 3-D digital differential analyser in one grid.
struct Walk {
    cell: i32,
    stride: vec3i,
    t_next: vec3f,
    t_step: vec3f,
    t_end: f32,
    // which bit of an empty cell tells that nothing lies this way: see direction_bin
    bin: u32,
}

// Directions fall into 24 bins: the axis of the largest component, and the signs of all three.
// trace/clear.py finds for each empty cell the bins in which no ray from it meets anything.
fn direction_bin(d: vec3f) -> u32 {
    let a = abs(d);
    let x = (a.x >= a.y) & (a.x >= a.z);
    let axis = select(select(2u, 1u, a.y >= a.z), 0u, x);
    let signs = select(vec3u(0u), vec3u(1u, 2u, 4u), d < vec3f(0.0));
    return 8u * axis + (signs.x | signs.y | signs.z);
}

// Whether a ray that stands in a cell will meet nothing any more.
fn is_clear(walk: Walk, cell: vec4u) -> bool {
    return ((cell.z >> walk.bin) & 1u) != 0u;
}

// The cell of a point inside a grid's box.
fn cell_of(grid: Grid, point: vec3f) -> vec3i {
    let place = (point - grid.origin) / grid.cell;
    return clamp(vec3i(floor(place)), vec3i(0), vec3i(grid.dims) - 1);
}

fn cell_index(grid: Grid, cell: vec3i) -> u32 {
    let c = vec3u(cell);
    return grid.cells + c.x + grid.dims.x * (c.y + grid.dims.y * c.z);
}

// Start where the ray enters the grid's box within [t_min, t_max]; t_end < 0 ... no cell at all.
fn walk_start(grid: Grid, ray: Ray, t_min: f32, t_max: f32) -> Walk {
    let inverse = safe_inverse(ray.direction);
    let size = vec3f(grid.dims) * grid.cell;
    let to_low = (grid.origin - ray.origin) * inverse;
    let to_high = (grid.origin + size - ray.origin) * inverse;
    let enter = min(to_low, to_high);
    let leave = max(to_low, to_high);
    let t0 = max(max(enter.x, enter.y), max(enter.z, t_min));
    let t1 = min(min(leave.x, leave.y), min(leave.z, t_max));
    var walk: Walk;
    walk.t_end = -NOTHING;
    if (t0 > t1) {
        return walk;
    }
    let cell = cell_of(grid, ray.origin + t0 * ray.direction);
    let forward = ray.direction >= vec3f(0.0);
    let edge = grid.origin + vec3f(cell + select(vec3i(0), vec3i(1), forward)) * grid.cell;
    let row = i32(grid.dims.x);
    let layer = row * i32(grid.dims.y);
    walk.cell = i32(cell_index(grid, cell));
    walk.stride = select(vec3i(-1, -row, -layer), vec3i(1, row, layer), forward);
    walk.t_next = (edge - ray.origin) * inverse;
    walk.t_step = abs(grid.cell * inverse);
    walk.bin = direction_bin(ray.direction);
    // a sliver less: crossings are sums of steps, and must not round to one more step out of the grid
    walk.t_end = t1 - 1e-3 * grid.cell;
    return walk;
}

// Start in the cell that holds the ray's origin: cheaper than to look for where the box is entered.
fn walk_from(grid: Grid, ray: Ray, cell: vec3i, t_max: f32) -> Walk {
    let inverse = safe_inverse(ray.direction);
    let forward = ray.direction >= vec3f(0.0);
    let to_low = grid.origin - ray.origin;
    let leave = (to_low + select(vec3f(0.0), vec3f(grid.dims) * grid.cell, forward)) * inverse;
    let next = cell + select(vec3i(0), vec3i(1), forward);
    let row = i32(grid.dims.x);
    let layer = row * i32(grid.dims.y);
    var walk: Walk;
    walk.cell = i32(cell_index(grid, cell));
    walk.stride = select(vec3i(-1, -row, -layer), vec3i(1, row, layer), forward);
    walk.t_next = (to_low + vec3f(next) * grid.cell) * inverse;
    walk.t_step = abs(grid.cell * inverse);
    walk.t_end = min(t_max, min(leave.x, min(leave.y, leave.z))) - 1e-3 * grid.cell;
    walk.bin = direction_bin(ray.direction);
    return walk;
}

// Where the ray leaves the cell.
fn walk_exit(walk: Walk) -> f32 {
    return min(walk.t_next.x, min(walk.t_next.y, walk.t_next.z));
}

// The axis along which the next cell lies.
fn next_axis(walk: Walk) -> vec3<bool> {
    let t = walk.t_next;
    let x = (t.x <= t.y) & (t.x <= t.z);
    let y = !x & (t.y <= t.z);
    return vec3<bool>(x, y, !(x | y));
}

// Go on to the next cell along the ray.
fn walk_on(walk: ptr<function, Walk>) {
    let axis = next_axis(*walk);
    (*walk).t_next += select(vec3f(0.0), (*walk).t_step, axis);
    let stride = select(vec3i(0), (*walk).stride, axis);
    (*walk).cell += stride.x + stride.y + stride.z;
}

// Where a flat walk goes next: to the next cell if `onward`, else from a cell to its first entry or
// from an entry to the one after it. One loop of such steps, without branches, keeps the lanes of a
// group from waiting for each other at the end of each cell.
fn walk_flat(
    walk: ptr<function, Walk>, texel: vec4u, index: u32, at_cell: bool, onward: bool,
) -> u32 {
    let axis = next_axis(*walk) & vec3<bool>(onward);
    (*walk).t_next += select(vec3f(0.0), (*walk).t_step, axis);
    let stride = select(vec3i(0), (*walk).stride, axis);
    (*walk).cell += stride.x + stride.y + stride.z;
    return select(select(index + 1u, texel.x, at_cell), u32((*walk).cell), onward);
}

// Leave the empty cells behind: afterwards the walk stands in a cell with entries, whose first is
// returned, or there is none and EMPTY_CELL is. A loop of its own, because adapters that run lanes
// in lockstep pay in every iteration for all that the loop may do.
fn next_entries(walk: ptr<function, Walk>) -> u32 {
    var cell = walked_at(u32((*walk).cell));
    loop {
        if (cell.y == 0u || is_clear(*walk, cell) || walk_exit(*walk) >= (*walk).t_end) {
            break;
        }
        walk_on(walk);
        cell = walked_at(u32((*walk).cell));
    }
    return select(cell.x, EMPTY_CELL, cell.y != 0u);
}
