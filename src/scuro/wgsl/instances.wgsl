// Rays among instances: which ones a ray meets, in the order of the cells of the grid over them, and
// the ray as an instance sees it.

//#include "trace_geometry.wgsl"
//#include "opacity.wgsl"

// A ray in the frame of an instance, and the planes' interval as the instance sees it.
struct Local {
    ray: Ray,
    kept: Kept,
    grid: Grid,
    // whether the bounding sphere is met in [t_min, t_max]
    near: bool,
    // whether it is an assembly: its grid lists instances
    nested: bool,
}

// The grid of an instance's geometry at the level of detail for its distance. Every instance changes
// level at a distance a little its own, so that a moving camera never sees many change at once.
fn grid_in_view(object: Traced, away: f32, index: u32) -> Grid {
    let spread = 0.8 + 0.4 * f32((index * 2654435769u) >> 8u) / 16777216.0;
    let allowed = spread
        * (scene.detail_floor + scene.detail_slope * away);
    var grid = object.grid;
    var coarser = object.coarser;
    while (coarser != 0u) {
        let next = traced_object(coarser);
        if (next.detail > allowed) {
            break;
        }
        grid = next.grid;
        coarser = next.coarser;
    }
    return grid;
}

// Rays may be told to pass through a range of objects, or of instances, as if they were not there.
override HAS_SKIPS: bool = false;

// objects [x, y) and instances [z, w)
var<private> skipped: vec4u;

fn skips(instance: u32, object: u32) -> bool {
    return (object >= skipped.x && object < skipped.y)
        || (instance >= skipped.z && instance < skipped.w);
}

// Whether all that a cell of a grid over instances lists is skipped.
fn skips_cell(cell: u32) -> bool {
    let objects = listed_objects(cell);
    return HAS_SKIPS && objects.x >= skipped.x && objects.y <= skipped.y;
}

// `eye` is the camera in the ray's frame.
fn local_view(ray: Ray, eye: vec3f, index: u32, t_min: f32, t_max: f32, kept: Kept) -> Local {
    let instance = instance_in(index, frame_at_hand);
    let object = traced_object(instance.object);
    let to_center = instance.center - ray.origin;
    let along = dot(to_center, ray.direction);
    let off = to_center - along * ray.direction;
    let half = sqrt(max(0.0, object.radius * object.radius - dot(off, off)));
    let inverse = conjugate(instance.rotation);
    var bounds = kept;
    if (CLIPPED && (object.flags & UNCLIPPED) != 0u) {
        bounds = ALL_KEPT;
    }
    var near = half > 0.0 && along - half <= t_max && along + half >= t_min;
    let nested = HAS_NESTING && (object.flags & NESTED) != 0u;
    if ((HAS_SKIPS || HAS_OPACITY) && !nested) {
        let number = leaf_number(index, frame_at_hand, instance.object);
        if (HAS_SKIPS && HAS_NESTING) {
            near = near && !skips(number, instance.object);
        }
        if (HAS_OPACITY) {
            near = near && meets(ray.origin, ray.direction, number, object.flags);
        }
    }
    var grid = object.grid;
    if (HAS_LEVELS && near) {
        grid = grid_in_view(object, distance(eye, instance.center), index);
    }
    return Local(
        Ray(rotate(inverse, -to_center), rotate(inverse, ray.direction)),
        bounds,
        grid,
        near,
        nested,
    );
}

// The instance that has a number, as a ray sees it.
fn view_of(ray: Ray, number: u32, object: u32) -> Local {
    let instance = numbered(number, object);
    let traced = traced_object(object);
    let inverse = conjugate(instance.rotation);
    var bounds = kept_interval(ray);
    if (CLIPPED && (traced.flags & UNCLIPPED) != 0u) {
        bounds = ALL_KEPT;
    }
    var grid = traced.grid;
    if (HAS_LEVELS) {
        grid = grid_in_view(traced, distance(scene.eye, instance.center), number);
    }
    let turned = Ray(
        rotate(inverse, ray.origin - instance.center), rotate(inverse, ray.direction),
    );
    return Local(turned, bounds, grid, true, false);
}

// The single instance of a scene that has no other: everything about it is in the uniform.
fn only_view(ray: Ray, kept: Kept) -> Local {
    let inverse = conjugate(scene.rotation);
    var bounds = kept;
    if (CLIPPED && scene.spared != 0u) {
        bounds = ALL_KEPT;
    }
    return Local(
        Ray(rotate(inverse, ray.origin - scene.center), rotate(inverse, ray.direction)),
        bounds,
        scene.top,
        true,
        false,
    );
}

// Where the walk over instances begins and ends: the planes bound it unless something is spared.
fn around(kept: Kept) -> Kept {
    if (CLIPPED && scene.spared != 0u) {
        return ALL_KEPT;
    }
    return kept;
}

// A walk through a grid over instances.
struct Search {
    walk: Walk,
    // the next entry of the cell at hand, EMPTY_CELL if it has no more
    index: u32,
    begun: bool,
    // how much of the ray the cell at hand decides
    t_cell: f32,
    // the last instances met need no second look
    seen: vec4u,
}

fn search_start(grid: Grid, ray: Ray, t_min: f32, t_max: f32, kept: Kept) -> Search {
    let bounds = around(kept);
    let walk = walk_start(grid, ray, max(t_min, bounds.near), min(t_max, bounds.far));
    return Search(walk, EMPTY_CELL, false, 0.0, vec4u(NO_INSTANCE));
}

const NO_INSTANCE: u32 = 0xffffffffu;

// As next_entries, in a grid over instances.
fn next_listed(walk: ptr<function, Walk>) -> u32 {
    var cell = listed_at(u32((*walk).cell));
    loop {
        let clear = cell >= NO_ENTRIES && ((cell >> (*walk).bin) & 1u) != 0u;
        let met = cell < NO_ENTRIES && !skips_cell(cell);
        if (met || clear || walk_exit(*walk) >= (*walk).t_end) {
            break;
        }
        walk_on(walk);
        cell = listed_at(u32((*walk).cell));
    }
    return select(EMPTY_CELL, first_listed(cell), cell < NO_ENTRIES && !skips_cell(cell));
}

// The next instance whose bounding sphere the ray meets in [t_min, t_max], or NO_INSTANCE.
fn next_instance(search: ptr<function, Search>, cell: f32, ray: Ray, t_min: f32, t_max: f32) -> u32 {
    var walk = (*search).walk;
    var index = (*search).index;
    var begun = (*search).begun;
    var t_cell = (*search).t_cell;
    var found = NO_INSTANCE;
    loop {
        if (index == EMPTY_CELL) {
            let t_exit = walk_exit(walk);
            if (walk.t_end < -1.0e38 || (begun && (t_exit >= walk.t_end || t_exit > t_max))) {
                break;
            }
            if (begun) {
                walk_on(&walk);
            }
            begun = true;
            index = next_listed(&walk);
            if (index == EMPTY_CELL) {
                break;
            }
            // what is entered beyond will be listed again in a later cell
            let t_next = walk_exit(walk);
            t_cell = select(t_next * 1.0001 + 1e-3 * cell, NOTHING, t_next >= walk.t_end);
        }
        // a tight loop over bounding spheres, until one is met or the cell ends
        var met = false;
        var last = false;
        var instance = NO_INSTANCE;
        loop {
            let entry = listed_at(index);
            instance = entry & ~LAST_OF_CELL;
            last = entry != instance;
            let place = place_at(instance, frame_at_hand);
            let span = sphere_span(ray, place.center, reach_of(place));
            met = span.near <= min(t_max, t_cell) && span.far >= t_min;
            if (HAS_SKIPS) {
                // most of what a ray meets is of its own region: passed before it is looked into;
                // instances in assemblies have their numbers from local_view
                let number = select(instance, NO_INSTANCE, HAS_NESTING);
                met = met && !skips(number, object_of(place.tag, scene.object_bits));
            }
            if (met || last) {
                break;
            }
            index += 1u;
        }
        index = select(index + 1u, EMPTY_CELL, last);
        if (met && all((*search).seen != vec4u(instance))) {
            found = instance;
            break;
        }
    }
    (*search).walk = walk;
    (*search).index = index;
    (*search).begun = begun;
    (*search).t_cell = t_cell;
    (*search).seen = vec4u(found, (*search).seen.xyz);
    return found;
}
