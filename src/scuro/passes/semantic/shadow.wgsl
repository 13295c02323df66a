// Pass 6: shadows between regions, by marching through the depth buffer towards the key light
// (Algorithm 4). Steps are bounded, and grow with the distance gone.

//#include "tiles.wgsl"
//#include "view.wgsl"
//#include "lights.wgsl"
//#include "region.wgsl"
//#include "halton.wgsl"

struct Shadow {
    steps: u32,
    // how far the march goes, scene units
    reach: f32,
    // what is thicker than this in depth does not block: it may lie far in front, scene units
    thickness: f32,
    // how dark a full shadow is
    strength: f32,
}

@group(2) @binding(0) var<uniform> shadow: Shadow;
@group(2) @binding(1) var<uniform> lights: Lights;
@group(2) @binding(2) var surface: texture_2d<f32>;
@group(2) @binding(3) var regions: texture_2d<u32>;
// 1 = lit
@group(2) @binding(4) var lit: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = tile_pixel(group, local);
    let size = textureDimensions(surface);
    if (any(pixel >= size)) {
        return;
    }
    let texel = textureLoad(surface, pixel, 0);
    if (texel.w <= 0.0 || lights.count == 0u) {
        textureStore(lit, pixel, vec4f(1.0));
        return;
    }
    let position = scene_position(vec2f(pixel) + 0.5, texel.w);
    let own = textureLoad(regions, pixel, 0).xy;
    let arriving = incoming_light(lights.list[0], position);
    let reach = min(shadow.reach, arriving.distance);
    let noise = pixel_noise(pixel + vec2u(view.origin), view.seed + 1u);
    let offset = fract(noise.x + f32(view.frame) * 0.618034);
    // at level t and at t + 1
    var blocked = vec2f(0.0);
    for (var i = 0u; i < shadow.steps; i += 1u) {
        let share = (f32(i) + offset) / f32(shadow.steps);
        let point = position + share * share * reach * arriving.direction;
        let projected = pixel_from_view((view.view_from_scene * vec4f(point, 1.0)).xyz);
        let at = vec2i(floor(projected.xy));
        if (projected.z <= 0.0 || any(at < vec2i(0)) || any(at >= vec2i(size))) {
            break;
        }
        let found = textureLoad(surface, at, 0).w;
        let above = projected.z - found;
        if (found > 0.0 && above > pixel_width(texel.w) && above < shadow.thickness) {
            blocked = max(blocked, vec2f(textureLoad(regions, at, 0).xy != own));
            if (all(blocked > vec2f(0.0))) {
                break;
            }
        }
    }
    let share = mix(blocked.x, blocked.y, levels.blend);
    textureStore(lit, pixel, vec4f(1.0 - shadow.strength * share));
}
