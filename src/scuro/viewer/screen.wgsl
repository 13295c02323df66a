// The picture on its way to the screen: enlarged if it is smaller, with outlines of the selection.

struct Screen {
    // physical pixels the picture takes, from the upper left corner
    size: vec2f,
    // how many entries of the list count
    selected: u32,
    // half the width of outlines, in texels of the picture
    reach: i32,
    color: vec4f,
    // 0 for one eye, 1 for two side by side, 2 for red-cyan glasses
    stereo: u32,
    // element and instance of each selected thing
    list: array<vec4u, 32>,
}

@group(0) @binding(0) var<uniform> screen: Screen;
@group(0) @binding(1) var picture: texture_2d<f32>;
@group(0) @binding(2) var ids: texture_2d<u32>;
// of the left eye, with glasses; ids otherwise
@group(0) @binding(3) var left_ids: texture_2d<u32>;

// behind the panel
const BESIDE = vec4f(0.1, 0.1, 0.11, 1.0);

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    // one triangle that covers the screen
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

fn texel(at: vec2i) -> vec4f {
    let last = vec2i(textureDimensions(picture)) - 1;
    let c = textureLoad(picture, clamp(at, vec2i(0), last), 0);
    // transparent pictures lie on light grey
    return vec4f(mix(vec3f(0.86), c.rgb, c.a), 1.0);
}

fn smooth_color(place: vec2f) -> vec4f {
    let corner = floor(place - 0.5);
    let part = place - 0.5 - corner;
    let at = vec2i(corner);
    let above = mix(texel(at), texel(at + vec2i(1, 0)), part.x);
    let below = mix(texel(at + vec2i(0, 1)), texel(at + vec2i(1, 1)), part.x);
    return mix(above, below, part.y);
}

fn is_selected(at: vec2i, left: bool) -> bool {
    var id: vec4u;
    if (left) {
        id = textureLoad(left_ids, at, 0);
    } else {
        id = textureLoad(ids, at, 0);
    }
    for (var i = 0u; i < screen.selected; i++) {
        if (all(id.xy == screen.list[i].xy)) {
            return true;
        }
    }
    return false;
}

// Whether the outline of something selected passes here, in the left eye's or the only picture.
fn outlined(place: vec2i, left: bool) -> bool {
    let size = vec2i(textureDimensions(ids));
    var low = vec2i(0);
    var high = size - 1;
    if (screen.stereo == 1u) {
        // the other eye's picture is not beside this one's
        low.x = select(0, size.x / 2, place.x >= size.x / 2);
        high.x = low.x + size.x / 2 - 1;
    }
    let here = is_selected(clamp(place, low, high), left);
    for (var y = -screen.reach; y <= screen.reach; y++) {
        for (var x = -screen.reach; x <= screen.reach; x++) {
            if (is_selected(clamp(place + vec2i(x, y), low, high), left) != here) {
                return true;
            }
        }
    }
    return false;
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    if (position.x > screen.size.x || position.y > screen.size.y) {
        return BESIDE;
    }
    let scale = vec2f(textureDimensions(picture)) / screen.size;
    let place = position.xy * scale;
    let color = smooth_color(place);
    if (screen.selected == 0u) {
        return color;
    }
    let at = vec2i(place * vec2f(textureDimensions(ids)) / vec2f(textureDimensions(picture)));
    let marked = outlined(at, false);
    var mask = vec4<bool>(marked);
    if (screen.stereo == 2u) {
        mask.x = outlined(at, true);  // each eye sees its own outline
    }
    return select(color, screen.color, mask);
}
