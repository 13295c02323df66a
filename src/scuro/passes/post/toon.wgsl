// Toon shading: the light that a surface sends back, relative to its base colour, in equal steps of
// perceived brightness. It works on the shaded picture: light, occlusion and shadow all become tones.

//#include "color.wgsl"

struct Toon {
    steps: f32,
}

@group(2) @binding(3) var<uniform> toon: Toon;

// Share of a step over which a tone passes into the next: a hard limit would alias.
const SOFTNESS: f32 = 0.12;

// `base` is the surface's own color.
fn toon_color(shaded: vec4f, base: vec4f) -> vec4f {
    let own = luminance(base.rgb);
    // square root: about even steps to the eye
    let tone = sqrt(max(luminance(shaded.rgb), 0.0) / max(own * shaded.a, 1e-4));
    let step = tone * toon.steps;
    // the brightest step is the surface's own colour
    let level = floor(step) + smoothstep(1.0 - SOFTNESS, 1.0, fract(step)) + 1.0;
    let gain = level / max(step, 1e-3);
    let lit = base.rgb * shaded.a * (level / toon.steps) * (level / toon.steps);
    // dark pixels have no hue left to scale: take the surface's own
    let kept = select(lit, shaded.rgb * gain * gain, step > 0.25);
    return select(shaded, vec4f(kept, shaded.a), base.a > 0.0);
}
