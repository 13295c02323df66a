// The camera of the picture, and the rays through its pixels.

//#include "ray.wgsl"

struct View {
    view_from_scene: mat4x4f,
    scene_from_view: mat4x4f,
    // of the whole picture, in pixels
    size: vec2f,
    // first pixel of this tile in the whole picture
    origin: vec2f,
    // half the picture's width and height: at distance 1, or in scene units (orthographic)
    half_extent: vec2f,
    // shift of the sample within its pixel, in pixels; (0, 0) is the center
    jitter: vec2f,
    orthographic: u32,
    // counts the frames since the picture last changed
    frame: u32,
    seed: u32,
    // distance from the eye to the middle of the scene
    distance: f32,
}

@group(0) @binding(0) var<uniform> view: View;

// Position in the picture, -1 to 1, y up, of a point in pixel units (centers at .5).
fn picture_from_pixel(pixel: vec2f) -> vec2f {
    let p = (pixel + view.origin + view.jitter) / view.size * 2.0 - 1.0;
    return vec2f(p.x, -p.y);
}

fn pixel_from_picture(picture: vec2f) -> vec2f {
    let p = vec2f(picture.x, -picture.y) * 0.5 + 0.5;
    return p * view.size - view.origin - view.jitter;
}

// View-space ray through a point of the tile, in pixel units; perspective rays start at the eye.
fn view_ray(pixel: vec2f) -> Ray {
    let at = picture_from_pixel(pixel) * view.half_extent;
    if (view.orthographic != 0u) {
        return Ray(vec3f(at, 0.0), vec3f(0.0, 0.0, -1.0));
    }
    return Ray(vec3f(0.0), normalize(vec3f(at, -1.0)));
}

fn scene_ray(pixel: vec2f) -> Ray {
    let ray = view_ray(pixel);
    return Ray(
        (view.scene_from_view * vec4f(ray.origin, 1.0)).xyz,
        (view.scene_from_view * vec4f(ray.direction, 0.0)).xyz,
    );
}

// View-space position of a pixel center at a depth (distance along -z).
fn view_position(pixel: vec2f, depth: f32) -> vec3f {
    let at = picture_from_pixel(pixel) * view.half_extent;
    return vec3f(at * select(depth, 1.0, view.orthographic != 0u), -depth);
}

fn scene_position(pixel: vec2f, depth: f32) -> vec3f {
    return (view.scene_from_view * vec4f(view_position(pixel, depth), 1.0)).xyz;
}

// Pixel (may be outside the tile) and depth of a view-space point.
fn pixel_from_view(p: vec3f) -> vec3f {
    let scale = select(-p.z, 1.0, view.orthographic != 0u);
    return vec3f(pixel_from_picture(p.xy / (scale * view.half_extent)), -p.z);
}

// Distance along a pixel's ray from its start to a depth.
fn ray_distance(pixel: vec2f, depth: f32) -> f32 {
    return depth / -view_ray(pixel).direction.z;
}

// Width of a pixel in scene units at a depth.
fn pixel_width(depth: f32) -> f32 {
    return 2.0 * view.half_extent.y / view.size.y * select(depth, 1.0, view.orthographic != 0u);
}

// Picture-plane interval of a sphere along one axis, in view units at distance 1 (or scene units):
// its tangents from the eye (Mara & McGuire 2013); everything when it reaches beside the eye.
fn picture_interval(along: f32, ahead: f32, radius: f32) -> vec2f {
    // Mesa's lavapipe compiles what branches on a uniform alone for the uniform's value, and loses
    // 200 kB at every dispatch in finding it again: the sign bit, always 0, hides the value
    if (view.orthographic + (bitcast<u32>(radius) >> 31u) != 0u) {
        return vec2f(along - radius, along + radius);
    }
    let square = along * along + ahead * ahead - radius * radius;
    if (square <= 0.0 || ahead <= radius) {
        return vec2f(-1e4, 1e4);
    }
    let c = sqrt(square);
    let low = vec2f(c * along - radius * ahead, radius * along + c * ahead);
    let high = vec2f(c * along + radius * ahead, c * ahead - radius * along);
    return vec2f(
        select(-1e4, low.x / low.y, low.y > 0.0),
        select(1e4, high.x / high.y, high.y > 0.0),
    );
}
