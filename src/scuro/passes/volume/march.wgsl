// Emission-absorption ray casting, front to back. Between two samples the value is taken to be
// linear, and the segment's extinction and middle come from integrals over the values in between
// (Engel, Kraus and Ertl 2001, section 3.3, here with one-dimensional tables), so that neither thin
// shells nor hard contours depend on where samples fall. The including shader defines
//   fn light_at(point: Point) -> vec3f
// the light that reaches a sample, which multiplies its color.

//#include "rays.wgsl"
//#include "segments.wgsl"

// Slow shaders march a ray in pieces of so many segments that are shaded; 0 for all at once. What is
// left through and the next segment's number go from piece to piece; a ray's end has no next one.
override PIECE: u32 = 0u;
var<private> piece: vec2f = vec2f(1.0, 0.0);
const ENDED: f32 = 1e9;

struct Result {
    // premultiplied linear color, opacity
    color: vec4f,
    // along the ray, of half the final opacity; 0 where nothing was met
    t: f32,
}

fn integrate(pixel: vec2u) -> Result {
    let ray = scene_ray(vec2f(pixel) + 0.5);
    let span = crossing(ray);
    let end = min(span.far, surface_limit(pixel));
    if (span.near >= end) {
        return Result(vec4f(0.0), 0.0);
    }
    if (ISOSURFACE) {
        return find_isosurface(ray, span, end, pixel);
    }
    let origin = texture_position(ray.origin);
    let direction = texture_direction(ray.direction);
    let inverse = 1.0 / select(direction * volume.size, vec3f(1e-20), abs(direction) < vec3f(1e-20));
    // segments end on a lattice, where the first is short by chance
    let lattice = span.near + volume.step * (1.0 - start_shift(pixel));
    var color = vec3f(0.0);
    var through = piece.x;
    var seen = 0.0;
    // the segment's number, and its front
    var k = piece.y;
    var front = Station(0.0, 0.0, 0u, vec4f(0.0));
    var known = false;
    // whether the segment before was
    var clear = true;
    var shaded = 0u;
    piece.y = ENDED;
    loop {
        // to the next segment that is not clear: an inner loop, so that groups of lanes with
        // nothing to shade do not run through the shading
        var back: Station;
        var depth = 0.0;
        loop {
            // leaps alone first: they need no sample. They stay on the ray's own lattice, so that
            // they do not change the picture, and end on its last place in the empty space. Matter
            // is not asked for emptiness: what follows it is taken for more until it is clear
            var t = front_of(k, span.near, lattice);
            var hops = select(0.0, 1.0, clear);
            for (; hops > 0.0 && t < end;) {
                let leap = empty_length((origin + t * direction) * volume.size, inverse);
                hops = max(floor(leap / volume.step - 0.001), 0.0);
                known = known && hops == 0.0;
                k += hops;
                t = front_of(k, span.near, lattice);
            }
            if (t >= end) {
                break;
            }
            if (!known) {
                front = station(t, origin + t * direction);
                known = true;
            }
            t = min(front_of(k + 1.0, span.near, lattice), end);
            back = station(t, origin + t * direction);
            depth = mean_extinction(front, back) * (back.t - front.t) / volume.voxel;
            if (depth > 0.0) {
                break;
            }
            front = back;
            clear = true;
            k += 1.0;
        }
        if (depth <= 0.0) {
            break;
        }
        let weight = through * (1.0 - exp(-depth));
        let share = centroid(front, back);
        let t = mix(front.t, back.t, share);
        var cut_normal = vec3f(0.0);
        if (span.cut < volume.cut_count && t < span.near + volume.step) {
            cut_normal = -volume.cuts[span.cut].xyz;
        }
        let uvw = origin + t * direction;
        let point = Point(ray.origin + t * ray.direction, uvw, ray.direction, t, weight,
            cut_normal, pixel);
        let half = mix(front.t, back.t, saturate(log(2.0 * through) / depth));
        color += weight * color_at(table_index(mix(front.value, back.value, share))).rgb
            * light_at(point);
        through -= weight;
        seen = select(seen, half, seen == 0.0 && through < 0.5);
        if (through < march.cutoff) {
            break;
        }
        front = back;
        clear = false;
        k += 1.0;
        if (PIECE > 0u) {
            shaded += 1u;
            if (shaded == PIECE) {
                piece.y = k;
                break;
            }
        }
    }
    if (PIECE > 0u) {
        piece.x = through;
        return Result(vec4f(color, 1.0 - through), seen);
    }
    return Result(whole(color, through), seen);
}

// Where segment `k` begins.
fn front_of(k: f32, near: f32, lattice: f32) -> f32 {
    return select(lattice + (k - 1.0) * volume.step, near, k < 1.0);
}

// What the cut-off left is spread over what was seen, so that opaque things are opaque.
fn whole(color: vec3f, through: f32) -> vec4f {
    let opacity = 1.0 - through;
    let full = select(1.0, 1.0 / max(opacity, 1e-6), through < march.cutoff);
    return vec4f(color, opacity) * full;
}

fn find_isosurface(ray: Ray, span: Crossing, end: f32, pixel: vec2u) -> Result {
    let origin = texture_position(ray.origin);
    let direction = texture_direction(ray.direction);
    let inverse = 1.0 / select(direction * volume.size, vec3f(1e-20), abs(direction) < vec3f(1e-20));
    var t = span.near;
    var last = t;
    var inside = false;
    while (t < end) {
        let uvw = origin + t * direction;
        let leap = empty_length(uvw * volume.size, inverse);
        if (leap > 0.0) {
            t += leap + 0.01 * volume.step;
            last = t;
            continue;
        }
        inside = value_at(uvw) >= march.iso;
        if (inside) {
            break;
        }
        last = t;
        t += volume.step;
    }
    if (!inside) {
        return Result(vec4f(0.0), 0.0);
    }
    let on_cut = t <= span.near && span.cut < volume.cut_count;
    if (!on_cut) {
        var low = last;
        for (var i = 0; i < 6; i++) {
            let middle = 0.5 * (low + t);
            if (value_at(origin + middle * direction) >= march.iso) {
                t = middle;
            } else {
                low = middle;
            }
        }
    }
    var cut_normal = vec3f(0.0);
    if (on_cut) {
        cut_normal = -volume.cuts[span.cut].xyz;
    }
    let point = Point(ray.origin + t * ray.direction, origin + t * direction, ray.direction, t, 1.0,
        cut_normal, pixel);
    return Result(vec4f(color_at(table_index(march.iso)).rgb * light_at(point), 1.0), t);
}
