// Guided attention: outside the chosen part of the scene light, colour or presence is taken away.

//#include "tiles.wgsl"
//#include "color.wgsl"

struct Attention {
    // 0 light, 1 colour, 2 presence
    how: u32,
    strength: f32,
}

@group(2) @binding(0) var<uniform> attention: Attention;
@group(2) @binding(1) var ids: texture_2d<u32>;
// see chosen_table in attention.py
@group(2) @binding(2) var<storage, read> chosen: array<u32>;
@group(2) @binding(3) var color: texture_2d<f32>;
@group(2) @binding(4) var replaced: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let id = tile_pixel(group, local);
    if (any(id >= textureDimensions(replaced))) {
        return;
    }
    let shaded = textureLoad(color, id, 0);
    let found = textureLoad(ids, id, 0);
    var is_chosen = 1u; // what is empty stays as it is, too
    if (found.z != 0xffffffffu) {
        is_chosen = chosen[found.z];
        if (is_chosen > 1u) {
            is_chosen = chosen[is_chosen + found.x];
        }
    }
    if (is_chosen != 0u) {
        textureStore(replaced, id, shaded);
        return;
    }
    var rest = vec4f(0.0, 0.0, 0.0, shaded.a);
    if (attention.how == 1u) {
        rest = vec4f(vec3f(luminance(shaded.rgb)), shaded.a);
    } else if (attention.how == 2u) {
        rest = vec4f(0.0); // premultiplied: the background shows instead
    }
    textureStore(replaced, id, mix(shaded, rest, attention.strength));
}
