// Segments of rays between two samples, from integrals over the values in between. The including
// shader brings volume.wgsl.

// Values differ by kind, not by degree: nothing lies between two labels.
override LABELS: bool = false;

// A sample of a ray: distance, value, entry of the tables, and its `integrals`.
struct Station {
    t: f32,
    value: f32,
    index: u32,
    sums: vec4f,
}

fn station(t: f32, uvw: vec3f) -> Station {
    let value = value_at(uvw);
    let index = table_index(value);
    return Station(t, value, index, textureLoad(integrals, vec2u(index, 0u), 0));
}

// Ends fewer entries apart than this have the mean of their own extinctions: entries are rounded,
// and so are differences of their integrals.
const NARROW: f32 = 4.0;

// Mean extinction coefficient per mean voxel edge; exactly 0 where all values are clear.
fn mean_extinction(front: Station, back: Station) -> f32 {
    if (LABELS) {
        return back.sums.z;
    }
    // not of the rounded entries: lengths go with the values, so that segments add up
    let apart = (back.value - front.value) * volume.table_end;
    let sum = (back.sums.x - front.sums.x) + (back.sums.y - front.sums.y);
    return select(sum / apart, 0.5 * (front.sums.z + back.sums.z), abs(apart) < NARROW);
}

// Share of the segment's length at which its matter has its centre of mass.
fn centroid(front: Station, back: Station) -> f32 {
    let apart = f32(back.index) - f32(front.index);
    let sum = (back.sums.x - front.sums.x) + (back.sums.y - front.sums.y);
    let place = (back.sums.w - front.sums.w) / select(sum, 1.0, sum == 0.0) - f32(front.index);
    let share = saturate(place / select(apart, 1.0, apart == 0.0));
    return select(share, select(0.5, 1.0, LABELS), LABELS || abs(apart) < NARROW || sum == 0.0);
}
