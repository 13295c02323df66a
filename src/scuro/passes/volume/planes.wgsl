// Planes through a volume that show its values: opaque, unlit, in the transfer function's colors.

//#include "view.wgsl"
//#include "volume.wgsl"

struct Planes {
    // where the planes across x, y and z lie, 0 to 1; negative for none
    at: vec3f,
    // pixels of the rim that tells which is which
    rim: f32,
    // width and height of the picture
    width: u32,
    height: u32,
}

@group(2) @binding(0) var<uniform> planes: Planes;
// scene normal and depth (-z in view space; 0 where empty) of the surfaces so far
@group(2) @binding(1) var surface: texture_2d<f32>;
@group(2) @binding(2) var color: texture_2d<f32>;
@group(2) @binding(3) var sliced_color: texture_storage_2d<rgba16float, write>;
@group(2) @binding(4) var sliced_surface: texture_storage_2d<rgba32float, write>;
@group(2) @binding(5) var volume_depth: texture_storage_2d<r32float, write>;

override SURFACES: bool = false;

fn kept(p: vec3f) -> bool {
    for (var i = 0u; i < volume.cut_count + (i >> 31u); i++) {
        if (dot(volume.cuts[i].xyz, p) + volume.cuts[i].w < 0.0) {
            return false;
        }
    }
    return true;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= planes.width || id.y >= planes.height) {
        return;
    }
    let pixel = vec2f(id.xy) + 0.5;
    let ray = scene_ray(pixel);
    let forward = -view_ray(pixel).direction.z;
    let origin = texture_position(ray.origin);
    let direction = texture_direction(ray.direction);
    var behind = vec4f(0.0);
    if (SURFACES) {
        behind = textureLoad(surface, id.xy, 0);
    }
    var nearest = select(3.0e38, behind.w / forward, behind.w > 0.0);
    var found = -1;
    for (var axis = 0; axis < 3; axis++) {
        let t = (planes.at[axis] - origin[axis]) / direction[axis];
        // NaN, of a ray in the plane, fails every comparison
        if (planes.at[axis] < 0.0 || !(t > 0.0 && t < nearest)) {
            continue;
        }
        var uvw = origin + t * direction;
        uvw[axis] = planes.at[axis];
        if (all(uvw >= vec3f(0.0)) && all(uvw <= vec3f(1.0)) && kept(ray.origin + t * ray.direction)) {
            nearest = t;
            found = axis;
        }
    }
    var shown = textureLoad(color, id.xy, 0);
    var depth = 0.0;
    if (found >= 0) {
        var uvw = origin + nearest * direction;
        uvw[found] = planes.at[found];
        depth = nearest * forward;
        var normal = vec3f(0.0);
        normal[found] = 1.0;
        let across = normalize((volume.scene_from_texture * vec4f(normal, 0.0)).xyz);
        behind = vec4f(across * -sign(dot(across, ray.direction)), depth);
        shown = vec4f(color_at(table_index(value_at(uvw))).rgb, 1.0);
        var margin = min(uvw, 1.0 - uvw) * volume.edges * volume.voxel;
        margin[found] = 3.0e38;
        if (min(margin.x, min(margin.y, margin.z)) < planes.rim * pixel_width(depth)) {
            shown = vec4f(0.05 + 0.75 * normal, 1.0);
        }
    }
    textureStore(sliced_color, id.xy, shown);
    textureStore(sliced_surface, id.xy, behind);
    textureStore(volume_depth, id.xy, vec4f(depth));
}
