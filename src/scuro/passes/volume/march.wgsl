// Emission-absorption ray casting, front to back. The including shader defines
//   fn light_at(point: Point) -> vec3f
// the light that reaches a sample, which multiplies its color.

//#include "rays.wgsl"

// Slow shaders march a ray in pieces of so many samples that are shaded; 0 for all at once. What is
// left through and the next sample's number go from piece to piece; a ray's end has no next sample.
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
    let start = span.near + volume.step * start_shift(pixel);
    var color = vec3f(0.0);
    var through = piece.x;
    var seen = 0.0;
    var k = piece.y;
    var shaded = 0u;
    piece.y = ENDED;
    loop {
        // to the next sample that is not clear: an inner loop, so that groups of lanes with
        // nothing to shade do not run through the shading
        var t: f32;
        var uvw: vec3f;
        var index: u32;
        var opacity = 0.0;
        loop {
            t = start + k * volume.step;
            // leaps alone first: they need no sample. They stay on the ray's own lattice of
            // samples, so that they do not change the picture
            var leap = 1.0;
            for (; leap > 0.0 && t < end;) {
                leap = empty_length((origin + t * direction) * volume.size, inverse);
                k += select(0.0, max(1.0, ceil(leap / volume.step - 0.001)), leap > 0.0);
                t = start + k * volume.step;
            }
            if (t >= end) {
                break;
            }
            uvw = origin + t * direction;
            index = table_index(value_at(uvw));
            opacity = textureLoad(step_opacity, vec2u(index, 0u), 0).x;
            if (opacity > 0.0) {
                break;
            }
            k += 1.0;
        }
        if (opacity <= 0.0) {
            break;
        }
        let weight = through * opacity;
        var cut_normal = vec3f(0.0);
        if (span.cut < volume.cut_count && k < 1.0) {
            cut_normal = -volume.cuts[span.cut].xyz;
        }
        let point = Point(ray.origin + t * ray.direction, uvw, ray.direction, t, weight,
            cut_normal, pixel);
        color += weight * color_at(index).rgb * light_at(point);
        through -= weight;
        seen = select(seen, t, seen == 0.0 && through < 0.5);
        if (through < march.cutoff) {
            break;
        }
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
