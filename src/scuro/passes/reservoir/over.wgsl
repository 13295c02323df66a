// The reservoir's picture over that of the surfaces behind and within it.

@group(2) @binding(0) var color: texture_2d<f32>;
@group(2) @binding(1) var volume_color: texture_2d<f32>;
@group(2) @binding(2) var combined: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= textureDimensions(combined))) {
        return;
    }
    let front = textureLoad(volume_color, id.xy, 0);
    textureStore(combined, id.xy, front + textureLoad(color, id.xy, 0) * (1.0 - front.a));
}
