// Primary visibility by rasterisation: a tight quad around each projected sphere or rod, whose
// fragments solve the same intersections as the tracer; triangles are drawn as themselves.

//#include "view.wgsl"
//#include "visible.wgsl"

// Slots a primitive: spheres, rods or triangles are drawn. A constant: a branch on a uniform would be
// compiled anew at every draw on lavapipe (docs/decisions.md).
override STRIDE: u32 = 1;

struct Draw {
    // first slot of the primitives drawn, and how many there are
    first: u32,
    count: u32,
    // first instance of the body
    instance: u32,
    // depth 1 (perspective), or depths 1 and 0 (orthographic)
    near: f32,
    far: f32,
    // of the tile that is drawn, in pixels
    tile: vec2f,
}

@group(2) @binding(0) var<uniform> draw: Draw;

struct Fragment {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) primitive: u32,
    @location(1) @interpolate(flat) instance: u32,
}

struct Output {
    @location(0) visible: vec4u,
    @builtin(frag_depth) depth: f32,
}

fn kind_at(slot: u32) -> u32 {
    if (STRIDE == 1u) {
        return SPHERE;
    }
    if (STRIDE == 3u) {
        return TRIANGLE;
    }
    let a = slot_at(slot).w;
    // as trace/pack.py decides
    return select(CONE, ROD, abs(a - slot_at(slot + 1u).w) <= 1e-5 * abs(slot_at(slot + 1u).w) + 1e-8);
}

fn view_from_local(index: u32, p: vec3f) -> vec3f {
    let instance = instance_at(index);
    let in_scene = instance.center + rotate(instance.rotation, p);
    return (view.view_from_scene * vec4f(in_scene, 1.0)).xyz;
}

fn clip_position(p: vec3f) -> vec4f {
    // no branch: see picture_interval
    let parallel = vec2f((draw.far + p.z) / (draw.far - draw.near), 1.0);
    let zw = select(vec2f(draw.near, -p.z), parallel, view.orthographic != 0u);
    return vec4f(p.xy / view.half_extent, zw);
}

fn tile_position(picture: vec2f) -> vec4f {
    // the tile's own clip space from the whole picture's
    let pixel = pixel_from_picture(picture);
    return vec4f(vec2f(pixel.x, draw.tile.y - pixel.y) / draw.tile * 2.0 - 1.0, 0.5, 1.0);
}

@vertex
fn quad(@builtin(vertex_index) corner: u32, @builtin(instance_index) index: u32) -> Fragment {
    let slot = draw.first + (index % draw.count) * STRIDE;
    let instance = draw.instance + index / draw.count;
    let a = slot_at(slot);
    let va = view_from_local(instance, a.xyz);
    var vb = va;
    var rb = a.w;
    if (STRIDE == 2u) {
        let b = slot_at(slot + 1u);
        vb = view_from_local(instance, b.xyz);
        rb = b.w;
    }
    // turn about the line of sight so that a rod lies along x: its quad is then tight
    let scale = select(vec2f(-va.z, -vb.z), vec2f(1.0), view.orthographic != 0u);
    var x_axis = vb.xy / max(scale.y, 1e-6) - va.xy / max(scale.x, 1e-6);
    x_axis = select(vec2f(1.0, 0.0), normalize(x_axis), dot(x_axis, x_axis) > 1e-20);
    let y_axis = vec2f(-x_axis.y, x_axis.x);
    let ax = picture_interval(dot(va.xy, x_axis), -va.z, a.w);
    let ay = picture_interval(dot(va.xy, y_axis), -va.z, a.w);
    let bx = picture_interval(dot(vb.xy, x_axis), -vb.z, rb);
    let by = picture_interval(dot(vb.xy, y_axis), -vb.z, rb);
    let x = vec2f(min(ax.x, bx.x), max(ax.y, bx.y));
    let y = vec2f(min(ay.x, by.x), max(ay.y, by.y));
    let px = select(x.x, x.y, (corner & 1u) != 0u);
    let py = select(y.x, y.y, (corner & 2u) != 0u);
    // half a pixel more: coverage is decided by the fragment, not by the quad's edge
    let widen = 1.0 / view.size.y * view.half_extent.y;
    let grown = vec2f(px, py) + widen * vec2f(select(-1.0, 1.0, (corner & 1u) != 0u),
        select(-1.0, 1.0, (corner & 2u) != 0u));
    var out: Fragment;
    out.position = tile_position((grown.x * x_axis + grown.y * y_axis) / view.half_extent);
    out.primitive = (kind_at(slot) << 29u) | slot;
    out.instance = instance;
    if (max(-va.z + a.w, -vb.z + rb) <= 0.0) {
        out.position = vec4f(2.0, 2.0, 2.0, 1.0); // wholly behind the eye
    }
    return out;
}

@vertex
fn corner(@builtin(vertex_index) vertex: u32, @builtin(instance_index) index: u32) -> Fragment {
    let slot = draw.first + (index % draw.count) * 3u;
    let instance = draw.instance + index / draw.count;
    let p = clip_position(view_from_local(instance, slot_at(slot + vertex).xyz));
    // shift the whole picture's clip space to the tile's, keeping w for clipping
    let scale = view.size / draw.tile;
    let offset = vec2f(
        (view.size.x - 2.0 * (view.origin.x + view.jitter.x)) / draw.tile.x - 1.0,
        1.0 - (view.size.y - 2.0 * (view.origin.y + view.jitter.y)) / draw.tile.y,
    );
    var out: Fragment;
    out.position = vec4f(p.xy * scale + offset * p.w, p.z, p.w);
    out.primitive = (TRIANGLE << 29u) | slot;
    out.instance = instance;
    return out;
}

fn stored_depth(t: f32, pixel: vec2f) -> f32 {
    let z = t * -view_ray(pixel).direction.z;
    let parallel = (draw.far - z) / (draw.far - draw.near);
    return select(draw.near / z, parallel, view.orthographic != 0u);
}

@fragment
fn solid(in: Fragment) -> Output {
    let ray = scene_ray(in.position.xy);
    let instance = instance_at(in.instance);
    let inverse = conjugate(instance.rotation);
    let local = Ray(rotate(inverse, ray.origin - instance.center), rotate(inverse, ray.direction));
    var kept = ALL_KEPT;
    if (CLIPPED && (traced_object(instance.object).flags & UNCLIPPED) == 0u) {
        kept = kept_interval(ray);
        if (kept.near >= kept.far) {
            discard;
        }
    }
    var hit = NO_HIT;
    var entry = Entry(vec4f(0.0), in.primitive, true);
    if (STRIDE == 1u) {
        entry = Entry(slot_at(slot_of(in.primitive)), NO_PRIMITIVE, true);
    }
    consider(local, entry, in.primitive, in.instance, 0.0, kept, &hit);
    if (hit.primitive == NO_PRIMITIVE) {
        discard;
    }
    var depth = stored_depth(hit.t, in.position.xy);
    if (hit.cap != 0u) {
        // all caps of a plane are equally near: the solid in which the point lies deepest wins; by
        // as much as tells depths apart, and nothing that is cut can lie before its cap
        depth *= 1.0 + 1e-3 * (1.0 - saturate(hit.depth));
    }
    return Output(pack_visible(hit), depth);
}

@fragment
fn flat_triangle(in: Fragment) -> Output {
    let ray = scene_ray(in.position.xy);
    let instance = instance_at(in.instance);
    let inverse = conjugate(instance.rotation);
    let local = Ray(rotate(inverse, ray.origin - instance.center), rotate(inverse, ray.direction));
    let slot = slot_of(in.primitive);
    let t = plane_hit(local, slot_at(slot).xyz, slot_at(slot + 1u).xyz, slot_at(slot + 2u).xyz).x;
    if (t <= 0.0 || t >= NOTHING) {
        discard;
    }
    if (CLIPPED && (traced_object(instance.object).flags & UNCLIPPED) == 0u) {
        let kept = kept_interval(ray);
        if (t < kept.near || t > kept.far) {
            discard;
        }
    }
    return Output(vec4u(in.primitive, in.instance, NO_FRAME, 0u), stored_depth(t, in.position.xy));
}
