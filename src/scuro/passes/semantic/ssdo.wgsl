// Pass 3: screen-space directional occlusion between regions (Algorithm 2) with one bounce of
// indirect light (equation 3.2).
//
// Two reaches: the near one tells atoms apart and fades out as the camera goes away; the far one
// counts occluders of another region only, at level t and at t + 1, and passes from one to the
// other. Light is gathered from the unoccluded directions with its own colour.

//#include "tiles.wgsl"
//#include "view.wgsl"
//#include "lights.wgsl"
//#include "region.wgsl"
//#include "halton.wgsl"

struct Ssdo {
    samples: u32,
    near_radius: f32,
    far_radius: f32,
    strength: f32,
    bounce: f32,
    // 1: occluders of the same region count too (the thesis's comparison without semantics)
    plain: u32,
}

@group(2) @binding(0) var<uniform> ssdo: Ssdo;
@group(2) @binding(1) var<uniform> lights: Lights;
@group(2) @binding(2) var surface: texture_2d<f32>;
@group(2) @binding(3) var regions: texture_2d<u32>;
@group(2) @binding(4) var diffuse: texture_2d<f32>;
// light from the unoccluded directions, as it falls on white; scalar visibility (1 = open)
@group(2) @binding(5) var gathered: texture_storage_2d<rgba16float, write>;
// indirect light of one bounce, as it falls on white
@group(2) @binding(6) var bounce: texture_storage_2d<rgba16float, write>;

override HAS_BOUNCE: bool = true;

// The mean of max(dot(w, l), 0) over cosine-distributed w is 2/3 where l is the normal: with this
// factor an open surface that faces a light is as bright as Lambert's law makes it.
const FACING: f32 = 1.5;

struct Sample {
    // 1 = the sample point lies behind what the picture shows there
    occluded: f32,
    pixel: vec2u,
}

fn probe(point: vec3f, depth: f32, radius: f32, size: vec2u) -> Sample {
    let projected = pixel_from_view((view.view_from_scene * vec4f(point, 1.0)).xyz);
    let at = vec2i(floor(projected.xy));
    if (projected.z <= 0.0 || any(at < vec2i(0)) || any(at >= vec2i(size))) {
        return Sample(0.0, vec2u(0u)); // what the picture does not show is open
    }
    let found = textureLoad(surface, at, 0).w;
    let skin = 0.5 * pixel_width(depth);
    if (found <= 0.0 || found > projected.z - skin) {
        return Sample(0.0, vec2u(at));
    }
    // far foreground does not darken what lies behind it
    let range = smoothstep(0.0, 1.0, radius / max(abs(depth - found), 1e-6));
    return Sample(range, vec2u(at));
}

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = tile_pixel(group, local);
    let size = textureDimensions(surface);
    if (any(pixel >= size)) {
        return;
    }
    let texel = textureLoad(surface, pixel, 0);
    if (texel.w <= 0.0) {
        textureStore(gathered, pixel, vec4f(0.0));
        textureStore(bounce, pixel, vec4f(0.0));
        return;
    }
    let normal = texel.xyz;
    let position = scene_position(vec2f(pixel) + 0.5, texel.w);
    let own = textureLoad(regions, pixel, 0).xy;
    let noise = pixel_noise(pixel + vec2u(view.origin), view.seed);
    let basis = tangent_frame(normal);
    let near_weight = select(1.0 - levels.depth, 1.0, ssdo.plain != 0u);
    var light = vec3f(0.0);
    var open_sum = 0.0;
    var indirect = vec3f(0.0);
    for (var i = 0u; i < ssdo.samples; i += 1u) {
        let u = fract(halton(i) + noise);
        let direction = basis * malley(u.xy);
        var near = 0.0;
        if (near_weight > 0.0) {
            let found = probe(position + u.z * ssdo.near_radius * direction, texel.w,
                ssdo.near_radius, size);
            near = found.occluded * near_weight;
            if (HAS_BOUNCE && near > 0.0) {
                let sender = textureLoad(surface, found.pixel, 0);
                let place = scene_position(vec2f(found.pixel) + 0.5, sender.w);
                let range = max(distance(place, position), 0.1 * ssdo.near_radius);
                let way = (place - position) / range;
                // equation 3.2 in units of the radius, with A_s = strength / N
                let form = max(dot(normal, way), 0.0) * max(dot(sender.xyz, -way), 0.0)
                    * ssdo.near_radius / range;
                indirect += near * form * textureLoad(diffuse, found.pixel, 0).rgb;
            }
        }
        let found = probe(position + u.z * ssdo.far_radius * direction, texel.w,
            ssdo.far_radius, size);
        var far = found.occluded;
        if (far > 0.0 && ssdo.plain == 0u) {
            let theirs = textureLoad(regions, found.pixel, 0).xy;
            let differs = vec2f(theirs != own);
            far *= mix(differs.x, differs.y, levels.blend);
        }
        let open = (1.0 - near) * (1.0 - far);
        open_sum += open;
        for (var k = 0u; k < lights.count; k += 1u) {
            let arriving = incoming_light(lights.list[k], position);
            light += open * FACING * max(dot(direction, arriving.direction), 0.0) * arriving.color;
        }
        light += open * lights.ambient;
    }
    let count = f32(ssdo.samples);
    let visibility = open_sum / count;
    // strength bends the curve: 1 leaves it, 0 takes all occlusion away
    let bend = pow(max(visibility, 1e-4), ssdo.strength - 1.0);
    textureStore(gathered, pixel, vec4f(light / count * bend, visibility * bend));
    textureStore(bounce, pixel,
        vec4f(indirect / count * ssdo.bounce * (1.0 - levels.depth), 1.0));
}
