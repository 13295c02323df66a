// A volume's dense part as a surface for the depth cues: where its opacity reaches a half, if that is
// nearer than the surface there. Its normals come from these depths.

//#include "view.wgsl"

@group(2) @binding(0) var surface: texture_2d<f32>;
@group(2) @binding(1) var volume_color: texture_2d<f32>;
@group(2) @binding(2) var volume_depth: texture_2d<f32>;
@group(2) @binding(3) var front: texture_storage_2d<rgba32float, write>;

// Depth of half the opacity, 0 where the volume is thinner than that or the picture ends.
fn depth_at(pixel: vec2i) -> f32 {
    let inside = all(pixel >= vec2i(0)) && all(pixel < vec2i(textureDimensions(front)));
    let at = select(vec2i(0), pixel, inside);
    return select(0.0, textureLoad(volume_depth, at, 0).x,
        inside && textureLoad(volume_color, at, 0).a >= 0.5);
}

// A step along the surface: of those to either side the one that changes depth less.
fn tangent(pixel: vec2i, step: vec2i, depth: f32) -> vec3f {
    let depths = vec2f(depth_at(pixel - step), depth_at(pixel + step));
    let changes = select(vec2f(3.0e38), abs(depths - depth), depths > vec2f(0.0));
    let onward = changes.y <= changes.x;
    let known = select(depths.x, depths.y, onward);
    let other = pixel + select(-step, step, onward);
    let way = view_position(vec2f(other) + 0.5, select(depth, known, known > 0.0))
        - view_position(vec2f(pixel) + 0.5, depth);
    return select(-way, way, onward);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= textureDimensions(front))) {
        return;
    }
    let pixel = vec2i(id.xy);
    let behind = textureLoad(surface, pixel, 0);
    let depth = depth_at(pixel);
    let across = cross(tangent(pixel, vec2i(0, 1), depth), tangent(pixel, vec2i(1, 0), depth));
    let normal = (view.scene_from_view * vec4f(normalize(across), 0.0)).xyz;
    let nearer = depth > 0.0 && (behind.w <= 0.0 || depth < behind.w);
    textureStore(front, pixel, select(behind, vec4f(normal, depth), nearer));
}
