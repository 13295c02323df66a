// Sample points about a pixel of the picture, and whether they lie behind it (Algorithm 2).

//#include "seen.wgsl"
//#include "labelled.wgsl"
//#include "halton.wgsl"
//#include "reach.wgsl"

struct Sample {
    // 1 = the sample point lies behind what the picture shows there
    occluded: f32,
    pixel: vec2u,
    there: Labelled,
}

// Whether a view-space point lies behind the picture.
fn probe(point: vec3f, here: Seen, radius: f32) -> Sample {
    let projected = pixel_from_view(point);
    let at = vec2i(floor(projected.xy));
    if (projected.z <= 0.0 || any(at < vec2i(0)) || any(at >= vec2i(here.size))) {
        return Sample(0.0, vec2u(0u), Labelled(vec2u(0u), 0.0, 0u)); // what the picture does not show is open
    }
    let found = labelled_at(vec2u(at));
    let skin = 0.5 * pixel_width(here.depth);
    let behind = found.depth > 0.0 && found.depth <= projected.z - skin;
    // far foreground does not darken what lies behind it
    let range = smoothstep(0.0, 1.0, radius / max(abs(here.depth - found.depth), 1e-6));
    return Sample(select(0.0, range, behind), vec2u(at), found);
}

// What all directions of a pixel share.
struct Place {
    here: Seen,
    noise: vec3f,
    // tangent space to scene space, and to view space
    basis: mat3x3f,
    turned: mat3x3f,
    // in view space, where the pixel of a sample point costs least
    start: vec3f,
}

fn place_of(here: Seen) -> Place {
    let basis = tangent_frame(here.normal);
    let m = view.view_from_scene;
    return Place(
        here,
        pixel_noise(here.pixel + vec2u(view.origin), view.seed),
        basis,
        mat3x3f(m[0].xyz, m[1].xyz, m[2].xyz) * basis,
        view_position(vec2f(here.pixel) + 0.5, here.depth),
    );
}

// The sample point of direction i.
struct Look {
    direction: vec3f,
    cosine: f32,
    // in view space, for a reach of 1
    step: vec3f,
}

fn look(i: u32, place: Place) -> Look {
    let u = fract(halton(i) + place.noise);
    let upright = malley(u.xy);
    return Look(place.basis * upright, upright.z, u.z * (place.turned * upright));
}
