// Which bricks of the illumination texture the picture's rays will read: the same march as the
// picture's, over fewer pixels, that leaves marks in place of color.

//#include "march.wgsl"

struct Bricks {
    // texels of the illumination texture
    size: vec3u,
    // bricks along x and y
    width: u32,
    height: u32,
}

@group(2) @binding(8) var<uniform> bricks: Bricks;
@group(2) @binding(9) var<storage, read_write> marks: array<u32>;

// edge of a brick in texels (illuminate.wgsl has the same)
const BRICK: u32 = 4u;

fn mark(brick: vec3u) {
    marks[(brick.z * bricks.height + brick.y) * bricks.width + brick.x] = 1u;
}

fn light_at(point: Point) -> vec3f {
    if (is_due(point)) {
        // neighboring rays, which are not cast, may read a texel farther than this one
        let at = light_place(point, vec3f(bricks.size)) * vec3f(bricks.size) - 0.5;
        let last = vec3f(bricks.size) - 1.0;
        let low = vec3u(clamp(at - 0.75, vec3f(0.0), last)) / BRICK;
        let high = vec3u(clamp(at + 1.75, vec3f(0.0), last)) / BRICK;
        for (var z = low.z; z <= high.z; z++) {
            for (var y = low.y; y <= high.y; y++) {
                for (var x = low.x; x <= high.x; x++) {
                    mark(vec3u(x, y, z));
                }
            }
        }
    }
    return vec3f(0.0);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x < march.width && id.y < march.height) {
        _ = integrate(id.xy);
    }
}
