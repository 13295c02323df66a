// Shading, depth cues and tones, and the encoded picture, one after another on a pixel in one pass:
// a software adapter pays more for passing the picture on than for most of them. Each is a function
// in a file of its own.

//#include "tiles.wgsl"
//#include "shaded.wgsl"
//#include "toon.wgsl"
//#include "fog.wgsl"
//#include "halos.wgsl"
//#include "borders.wgsl"
//#include "brightness.wgsl"
//#include "encoded.wgsl"

@group(2) @binding(1) var color: texture_2d<f32>;
@group(2) @binding(4) var albedo: texture_2d<f32>;
@group(2) @binding(2) var replaced: texture_storage_2d<rgba16float, write>;
@group(2) @binding(9) var picture: texture_storage_2d<rgba8unorm, write>;
@group(2) @binding(11) var nearest: sampler; // nearest

// Whether `color` is still to be made.
override SHADING: bool = false;
override TOON: bool = false;
override FOG: bool = false;
override HALOS: bool = false;
// Borders of at most two pixels, and wider ones.
override LINES: bool = false;
override WIDE_LINES: bool = false;
// What FXAA compares.
override BRIGHTNESS: bool = false;
// The picture, too.
override PICTURE: bool = false;

// All of a pixel; `halo` and `line` are its shares of these. They are found first: after shading, more
// would have to be kept meanwhile than a processor has registers.
fn draw(pixel: vec2u, texel: vec4f, halo: f32, line: f32) {
    var base: vec4f;
    if (SHADING || TOON) {
        base = textureLoad(albedo, pixel, 0);
    }
    var shown: vec4f;
    if (SHADING) {
        shown = shaded(pixel, texel, base.rgb);
    } else {
        shown = textureLoad(color, pixel, 0);
    }
    if (TOON) {
        shown = toon_color(shown, base);
    }
    if (FOG) {
        shown = mix(shown, fog.color * shown.a, fog_amount(texel.w));
    }
    if (HALOS) {
        shown = mix(shown, vec4f(halos.color, 1.0), halo);
    }
    if (LINES || WIDE_LINES) {
        shown = mix(shown, vec4f(borders.color, 1.0), line);
    }
    if (BRIGHTNESS) {
        // cut to what a half keeps of it: where other passes come between, FXAA finds the same edges
        let kept = bitcast<vec4f>(bitcast<vec4u>(shown) & vec4u(0xffffe000u));
        store_brightness(pixel, kept);
    }
    textureStore(replaced, pixel, shown);
    if (PICTURE) {
        textureStore(picture, pixel, encoded(shown));
    }
}

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = tile_pixel(group, local);
    if (any(pixel >= textureDimensions(replaced))) {
        return;
    }
    let texel = textureLoad(surface, pixel, 0);
    var halo = 0.0;
    if (HALOS) {
        halo = halo_strength(pixel, texel.w);
    }
    var line = 0.0;
    if (LINES) {
        line = thin_line(pixel, texel);
    }
    if (WIDE_LINES) {
        line = wide_line(pixel, texel);
    }
    draw(pixel, texel, halo, line);
}
