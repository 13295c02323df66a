// Occlusion and shadows of one point, by cones: toward the viewer, and toward each light.

//#include "view.wgsl"
//#include "peers.wgsl"
//#include "lamps.wgsl"

override OCCLUSION: bool = false;
override SHADOWS: bool = false;

fn to_viewer(p: vec3f) -> vec3f {
    if (view.orthographic != 0u) {
        return view.scene_from_view[2].xyz;
    }
    return normalize(view.scene_from_view[3].xyz - p);
}

// Visibility toward the viewer, and of the lights of shadow layers 0, 1 and 2.
fn illumination(p: vec3f) -> vec4f {
    var out = vec4f(1.0);
    if (OCCLUSION) {
        out.x = transparency(OCCLUSION_CONE, p, to_viewer(p), NOTHING);
    }
    if (SHADOWS) {
        for (var i = 0u; i < LIGHT_COUNT + (i >> 31u); i++) {
            let layer = lights.list[i].shadow;
            if (layer >= 0 && layer < 3) {
                let arriving = incoming_light(lights.list[i], p);
                out[1 + layer] = transparency(SHADOW_CONE, p, arriving.direction,
                    arriving.distance);
            }
        }
    }
    return out;
}
