// The region that an element belongs to at a level of the hierarchy (scene/regions.py).

const BY_OBJECT: u32 = 0u;
const BY_INSTANCE: u32 = 1u;
const BY_GROUP: u32 = 2u;
const NO_GROUPS: u32 = 0xffffffffu;

struct LevelOf {
    kind: u32,
    // first entry of its labels (BY_OBJECT) or offsets (BY_GROUP) in `region_table`
    table: u32,
    // structs in a uniform are multiples of 16 bytes
    pad0: u32,
    pad1: u32,
}

struct Levels {
    here: LevelOf,
    next: LevelOf,
    // first entry in `region_table` of: numbers of fibres, ranges of objects, groups of elements
    fibres: u32,
    ranges: u32,
    groups: u32,
    pad: u32,
    // how far the camera is from level t towards t + 1
    blend: f32,
    // 1 at the farthest threshold and beyond, 0 at the nearest
    depth: f32,
}

@group(3) @binding(0) var<uniform> levels: Levels;
@group(3) @binding(1) var<storage, read> region_table: array<u32>;

// A label that differs between any two different pairs, but for rare chance.
fn pair_label(a: u32, b: u32) -> u32 {
    var h = (a + 1u) * 0x9e3779b9u ^ (b + 0x7f4a7c15u) * 0x85ebca6bu;
    h = (h ^ (h >> 15u)) * 0x2c1b3c6du;
    return (h ^ (h >> 13u)) | 1u;
}

// First and end of the run of objects around one that share its region at a BY_OBJECT level.
fn region_range(level: LevelOf, object: u32) -> vec2u {
    let at = levels.ranges + 2u * (level.table + object);
    return vec2u(region_table[at], region_table[at + 1u]);
}

// Never 0.
fn region_of(level: LevelOf, object: u32, instance: u32, element: u32) -> u32 {
    if (level.kind == BY_OBJECT) {
        return region_table[level.table + object] + 1u;
    }
    let fibre = region_table[levels.fibres + object];
    if (fibre != 0u) {
        // a curve comes in pieces: its number within its ingredient tells it apart
        return pair_label(0x80000000u + fibre, element);
    }
    if (level.kind == BY_GROUP) {
        let offset = region_table[level.table + object];
        if (offset != NO_GROUPS) {
            return pair_label(instance, region_table[levels.groups + offset + element] + 2u);
        }
    }
    return pair_label(instance, 0u);
}
