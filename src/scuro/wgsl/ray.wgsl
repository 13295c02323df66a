// A ray, and the exact ray-primitive intersections. Directions are unit vectors.

struct Ray {
    origin: vec3f,
    direction: vec3f,
}

const NOTHING: f32 = 3.0e38;

// Entry and exit distances of a solid; entry > exit when the ray misses it.
struct Span {
    near: f32,
    far: f32,
}

const MISS = Span(3.0e38, -3.0e38);

// Discriminant from the perpendicular offset: b*b - c cancels for far or large spheres
// (Haines et al., Ray Tracing Gems, chapter 7).
fn sphere_span(ray: Ray, center: vec3f, radius: f32) -> Span {
    let to_center = center - ray.origin;
    let along = dot(to_center, ray.direction);
    let off = to_center - along * ray.direction;
    let square = radius * radius - dot(off, off);
    let half = sqrt(max(square, 0.0));
    let met = square >= 0.0;
    return Span(select(NOTHING, along - half, met), select(-NOTHING, along + half, met));
}

// A solid cylinder with flat ends at a and b.
fn cylinder_span(ray: Ray, a: vec3f, b: vec3f, radius: f32) -> Span {
    let axis_vector = b - a;
    let axis_length = length(axis_vector);
    if (axis_length < 1e-12) {
        return MISS;
    }
    let axis = axis_vector / axis_length;
    // slab between the two ends
    let from_a = ray.origin - a;
    let height = dot(from_a, axis);
    let slope = dot(ray.direction, axis);
    var near = -NOTHING;
    var far = NOTHING;
    if (abs(slope) > 1e-7) {
        let t0 = -height / slope;
        let t1 = (axis_length - height) / slope;
        near = min(t0, t1);
        far = max(t0, t1);
    } else if (height < 0.0 || height > axis_length) {
        return MISS;
    }
    // infinite cylinder, in the plane across the axis, again from the perpendicular offset
    let across_origin = from_a - height * axis;
    let across_direction = ray.direction - slope * axis;
    let speed2 = dot(across_direction, across_direction);
    if (speed2 < 1e-12) {
        if (dot(across_origin, across_origin) > radius * radius) {
            return MISS;
        }
        return Span(near, far);
    }
    let along = -dot(across_origin, across_direction) / speed2;
    let off = across_origin + along * across_direction;
    let square = (radius * radius - dot(off, off)) / speed2;
    if (square < 0.0) {
        return MISS;
    }
    let half = sqrt(square);
    near = max(near, along - half);
    far = min(far, along + half);
    if (near > far) {
        return MISS;
    }
    return Span(near, far);
}

// Entry into the rounded cone around a (radius ra) and b (radius rb): two spheres and the cone
// tangent to both. Only the entry is solved; the exit comes from the reversed ray.
fn cone_entry(ray: Ray, a: vec3f, b: vec3f, ra: f32, rb: f32) -> f32 {
    var nearest = min(
        sphere_span(ray, a, ra).near,
        sphere_span(ray, b, rb).near,
    );
    let axis_vector = b - a;
    let length2 = dot(axis_vector, axis_vector);
    let step = ra - rb;
    let side2 = length2 - step * step;
    if (side2 <= 0.0) {
        return nearest; // one sphere holds the other
    }
    // start near the cone, so that squares stay small
    let middle = 0.5 * (a + b);
    let start = dot(middle - ray.origin, ray.direction);
    let from_a = ray.origin + start * ray.direction - a;
    let slope = dot(axis_vector, ray.direction);
    let height = dot(axis_vector, from_a);
    // the tangent cone: side2 |p|^2 - h^2 + 2 ra step h - l^2 ra^2 = 0 with h = axis . p, l = |axis|
    let c2 = side2 - slope * slope;
    let c1 = side2 * dot(from_a, ray.direction) - height * slope + ra * step * slope;
    let c0 = side2 * dot(from_a, from_a) - height * height + 2.0 * ra * step * height
        - length2 * ra * ra;
    let square = c1 * c1 - c2 * c0;
    if (square >= 0.0 && abs(c2) > 1e-12) {
        let root = sqrt(square);
        for (var side = -1.0; side <= 1.0; side += 2.0) {
            let t = (-c1 + side * root) / c2;
            let y = height - ra * step + t * slope;
            if (y > 0.0 && y < side2 && start + t < nearest) {
                // entering only: the normal faces the ray
                let normal = side2 * (from_a + t * ray.direction) - axis_vector * y;
                if (dot(normal, ray.direction) < 0.0) {
                    nearest = start + t;
                }
            }
        }
    }
    return nearest;
}

fn cone_span(ray: Ray, a: vec3f, b: vec3f, ra: f32, rb: f32) -> Span {
    let near = cone_entry(ray, a, b, ra, rb);
    if (near >= NOTHING) {
        return MISS;
    }
    return Span(near, -cone_entry(Ray(ray.origin, -ray.direction), a, b, ra, rb));
}

// Outward normal of a rounded cone at a point of its surface.
fn cone_normal(p: vec3f, a: vec3f, b: vec3f, ra: f32, rb: f32) -> vec3f {
    let axis_vector = b - a;
    let length2 = dot(axis_vector, axis_vector);
    let step = ra - rb;
    let side2 = length2 - step * step;
    let y = dot(axis_vector, p - a) - ra * step;
    if (side2 <= 0.0) {
        return normalize(select(p - b, p - a, ra > rb));
    }
    if (y <= 0.0) {
        return normalize(p - a);
    }
    if (y >= side2) {
        return normalize(p - b);
    }
    return normalize(side2 * (p - a) - axis_vector * y);
}

// Where a ray meets a triangle's plane (Moller & Trumbore): (t, weight of b, weight of c).
fn plane_hit(ray: Ray, a: vec3f, b: vec3f, c: vec3f) -> vec3f {
    let ab = b - a;
    let ac = c - a;
    let p = cross(ray.direction, ac);
    let det = dot(ab, p);
    if (abs(det) < 1e-20) {
        return vec3f(NOTHING, 0.0, 0.0);
    }
    let from_a = ray.origin - a;
    let u = dot(from_a, p) / det;
    let q = cross(from_a, ab);
    return vec3f(dot(ac, q) / det, u, dot(ray.direction, q) / det);
}

// Rounding must not open a gap between two triangles that share an edge.
const EDGE_OVERLAP: f32 = 1e-5;

// The same within the triangle, from either side; t = NOTHING for a miss.
fn triangle_hit(ray: Ray, a: vec3f, b: vec3f, c: vec3f) -> vec3f {
    let hit = plane_hit(ray, a, b, c);
    if (min(hit.y, hit.z) < -EDGE_OVERLAP || hit.y + hit.z > 1.0 + EDGE_OVERLAP) {
        return vec3f(NOTHING, 0.0, 0.0);
    }
    return hit;
}
