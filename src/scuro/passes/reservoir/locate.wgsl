// Which cell a point lies in, and where: Newton's method in the trilinear map of a cell, searching
// on from the cell before, or through the areal grid (Franceschin et al.; Campagnolo 2021, 4.1.3).

//#include "cells.wgsl"

const MOST_ITERATIONS: i32 = 10;
const MOST_HOPS: i32 = 12;
// parametric coordinates this far outside still count as inside
const INSIDE: f32 = 1e-4;

struct Located {
    found: bool,
    layer: i32,
    at: vec3f,
}

// Parametric coordinates of a point in a cell, from a guess; far outside they are only a direction.
fn parametric(frame: Frame, top: vec4f, bottom: vec4f, p: vec3f, guess: vec3f) -> vec3f {
    var at = guess;
    let rise = bottom - top;
    let x0 = frame.x - p.x;
    let y0 = frame.y - p.y;
    for (var n = 0; n < MOST_ITERATIONS; n++) {
        let z = top + at.z * rise;
        let x = x0 + frame.slope_x * z;
        let y = y0 + frame.slope_y * z;
        let weights = ring_weights(at.xy);
        let along_s = vec4f(at.y - 1.0, 1.0 - at.y, at.y, -at.y);
        let along_t = vec4f(at.x - 1.0, -at.x, at.x, 1.0 - at.x);
        let miss = vec3f(dot(weights, x), dot(weights, y), dot(weights, z - p.z));
        let by_s = vec3f(dot(along_s, x), dot(along_s, y), dot(along_s, z));
        let by_t = vec3f(dot(along_t, x), dot(along_t, y), dot(along_t, z));
        let by_r = vec3f(
            dot(weights, frame.slope_x * rise), dot(weights, frame.slope_y * rise), dot(weights, rise));
        let across = cross(by_t, by_r);
        let volume = dot(by_s, across);
        if (abs(volume) < 1e-12) {
            break; // a collapsed cell holds no point
        }
        let step = vec3f(dot(miss, across), dot(miss, cross(by_r, by_s)), dot(miss, cross(by_s, by_t)))
            / volume;
        // damped: beyond a neighbor's distance the map is only extrapolated
        at = clamp(at - clamp(step, vec3f(-1.0), vec3f(1.0)), vec3f(-2.0), vec3f(3.0));
        if (all(abs(step) < vec3f(2e-6))) {
            break;
        }
    }
    return at;
}

// Follow the overshoot from a cell to its neighbors until one holds the point.
fn search(frame: ptr<function, Frame>, layer_from: i32, guess: vec3f, p: vec3f) -> Located {
    var layer = layer_from;
    var at = guess;
    for (var hop = 0; hop < MOST_HOPS; hop++) {
        at = parametric(*frame, surface_z(*frame, layer), surface_z(*frame, layer + 1), p, at);
        let over = max(-at, at - 1.0);
        if (max(over.x, max(over.y, over.z)) <= INSIDE) {
            return Located(true, layer, at);
        }
        if (over.z >= max(over.x, over.y)) {
            let down = at.z > 0.5;
            layer += select(-1, 1, down);
            if (layer < 0 || layer + 1 >= (*frame).column.count) {
                break;
            }
            at.z = select(1.0, 0.0, down);
            continue;
        }
        var side = select(0, 2, at.y > 0.5);
        if (over.x > over.y) {
            side = select(3, 1, at.x > 0.5);
        }
        let index = (*frame).index + side_step(side);
        if (!in_grid(index)) {
            break;
        }
        let next = column_at(index);
        if (next.count == 0) {
            break;
        }
        at -= vec3f(vec2f(side_step(side)), 0.0);
        layer = clamp(layer + (*frame).column.first - next.first, 0, next.count - 2);
        *frame = frame_of(index);
    }
    return Located(false, 0, vec3f(0.0));
}

// Areal coordinates of a point in a column's cut at the point's height.
fn areal_coordinates(frame: Frame, p: vec3f) -> vec2f {
    let x = frame.x + frame.slope_x * p.z - p.x;
    let y = frame.y + frame.slope_y * p.z - p.y;
    var at = vec2f(0.5);
    for (var n = 0; n < 5; n++) {
        let weights = ring_weights(at);
        let along_s = vec4f(at.y - 1.0, 1.0 - at.y, at.y, -at.y);
        let along_t = vec4f(at.x - 1.0, -at.x, at.x, 1.0 - at.x);
        let miss = vec2f(dot(weights, x), dot(weights, y));
        let by_s = vec2f(dot(along_s, x), dot(along_s, y));
        let by_t = vec2f(dot(along_t, x), dot(along_t, y));
        let area = by_s.x * by_t.y - by_s.y * by_t.x;
        if (abs(area) < 1e-12) {
            return vec2f(-9.0);
        }
        let step = vec2f(miss.x * by_t.y - miss.y * by_t.x, by_s.x * miss.y - by_s.y * miss.x) / area;
        at = clamp(at - step, vec2f(-3.0), vec2f(4.0));
    }
    return at;
}

fn voxel_of(p: vec3f) -> vec2i {
    return vec2i(floor((p.xy - model.areal_origin) / model.areal_voxel));
}

// The cell that holds a point, through the areal grid.
fn locate(p: vec3f, frame: ptr<function, Frame>) -> Located {
    let voxel = voxel_of(p);
    if (any(voxel < vec2i(0)) || any(voxel >= vec2i(model.areal_dims))) {
        return Located(false, 0, vec3f(0.0));
    }
    let over = voxel_at(voxel);
    if (p.z < over.low || p.z > over.high) {
        return Located(false, 0, vec3f(0.0));
    }
    for (var n = 0; n < over.count; n++) {
        *frame = frame_of(listed_column(over.first + n));
        let at = areal_coordinates(*frame, p);
        // cells' sides bulge a little where pillars are not parallel
        if (any(at < vec2f(-0.05)) || any(at > vec2f(1.05))) {
            continue;
        }
        let layer = layer_around(*frame, at, p.z);
        let start = clamp(layer, 0, (*frame).column.count - 2);
        let found = search(frame, start, vec3f(at, 0.5), p);
        if (found.found) {
            return found;
        }
    }
    return Located(false, 0, vec3f(0.0));
}

fn value_in(column: Column, layer: i32, at: vec3f) -> f32 {
    return trilinear(surface_values(column, layer), surface_values(column, layer + 1), at);
}
