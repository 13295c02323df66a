// Depth cues and tones, one after another on a pixel in one pass: a software adapter pays more for
// passing the picture on than for most of them. Each cue is a function in a file of its own.

//#include "view.wgsl"
//#include "tiles.wgsl"
//#include "toon.wgsl"
//#include "fog.wgsl"
//#include "halos.wgsl"
//#include "borders.wgsl"
//#include "brightness.wgsl"

@group(2) @binding(1) var color: texture_2d<f32>;
@group(2) @binding(2) var replaced: texture_storage_2d<rgba16float, write>;

override TOON: bool = false;
override FOG: bool = false;
override HALOS: bool = false;
// Borders of at most two pixels, and wider ones.
override LINES: bool = false;
override WIDE_LINES: bool = false;
// What FXAA compares.
override BRIGHTNESS: bool = false;

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = tile_pixel(group, local);
    if (any(pixel >= textureDimensions(replaced))) {
        return;
    }
    var shown = textureLoad(color, pixel, 0);
    let texel = textureLoad(surface, pixel, 0);
    if (TOON) {
        shown = toon_color(shown, pixel);
    }
    if (FOG) {
        shown = mix(shown, fog.color * shown.a, fog_amount(texel.w));
    }
    if (HALOS) {
        shown = mix(shown, vec4f(halos.color, 1.0), halo_strength(pixel, texel.w));
    }
    if (LINES) {
        shown = mix(shown, vec4f(borders.color, 1.0), thin_line(pixel, texel));
    }
    if (WIDE_LINES) {
        shown = mix(shown, vec4f(borders.color, 1.0), wide_line(pixel, texel));
    }
    if (BRIGHTNESS) {
        store_brightness(pixel, shown);
    }
    textureStore(replaced, pixel, shown);
}
