// The volume's picture over that of the surfaces behind and within it.

@group(2) @binding(0) var color: texture_2d<f32>;
@group(2) @binding(1) var volume_color: texture_2d<f32>;
// share of their light that the volume leaves to surfaces
@group(2) @binding(3) var surface_light: texture_2d<f32>;
@group(2) @binding(4) var ids: texture_2d<u32>;
@group(2) @binding(2) var combined: texture_storage_2d<rgba16float, write>;

override SURFACES: bool = false;
// objects from this number on are in simple light, which nothing takes (passes/compose/context.py)
override CONTEXT_FROM: u32 = 0xffffffffu;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= textureDimensions(combined))) {
        return;
    }
    let front = textureLoad(volume_color, id.xy, 0);
    var back = textureLoad(color, id.xy, 0);
    if (SURFACES && textureLoad(ids, id.xy, 0).z < CONTEXT_FROM) {
        back = vec4f(back.rgb * textureLoad(surface_light, id.xy, 0).x, back.a);
    }
    textureStore(combined, id.xy, front + back * (1.0 - front.a));
}
