// Whether rays meet another region: the semantics of traced mode.

//#include "trace.wgsl"
//#include "surface.wgsl"
//#include "region.wgsl"

// Whether either level divides instances into groups of atoms.
override HAS_GROUPS: bool = true;

// A ray inside one instance passes at most so many atoms of its own group.
const MOST_OWN: u32 = 32u;

// Whether something of another region lies on the ray.
fn blocked(ray: Ray, reach: f32, level: LevelOf, own: vec4u) -> bool {
    skipped = vec4u(0u);
    if (level.kind == BY_OBJECT) {
        let range = region_range(level, own.z);
        skipped = vec4u(range, 0u, 0u);
    } else if (!HAS_GROUPS || level.kind == BY_INSTANCE) {
        skipped = vec4u(0u, 0u, own.y, own.y + 1u);
    } else {
        // groups of atoms: step through those of the own group
        let label = region_of(level, own.z, own.y, own.x);
        var t = 0.0;
        for (var i = 0u; i < MOST_OWN; i += 1u) {
            let hit = trace_nearest(ray, t, reach);
            if (hit.primitive == NO_PRIMITIVE) {
                return false;
            }
            let found = surface_at(ray, hit);
            if (region_of(level, found.object, found.instance, found.element) != label) {
                return true;
            }
            t = hit.t + 0.01 * scene.primitive_radius;
        }
        return false;
    }
    return trace_any(ray, 0.0, reach);
}
