// Layers of a column as rays cross them: cells that are seen one by one, hidden ones that lie upon
// each other as one.

//#include "cells.wgsl"

struct Run {
    first: i32,
    last: i32,
    shown: bool,
}

// The run that has a layer as its upper end (down) or lower end; of layers in one word of flags.
fn run_from(column: Column, layer: i32, down: bool) -> Run {
    let run = run_around(column, layer);
    return Run(select(run.first, layer, down), select(layer, run.last, down), run.shown);
}

// The whole run around a layer.
fn run_around(column: Column, layer: i32) -> Run {
    let word = flag_words(column, layer).x;
    let bit = layer & 31;
    if (has_bit(word, layer)) {
        return Run(layer, layer, true);
    }
    let base = layer - bit;
    let above = word & ((1u << u32(bit)) - 1u);
    let below = word >> u32(bit);
    let first = base + select(i32(firstLeadingBit(above)) + 1, 0, above == 0u);
    let last = select(layer + i32(firstTrailingBit(below)) - 1, base + 31, below == 0u);
    return Run(first, min(last, column.count - 2), false);
}

struct Beside {
    found: bool,
    run: Run,
    // how far down in the run
    r: f32,
}

// The run around a height in a column that a ray comes into from the side: the one around the layer
// asked about if that fits, as it does but at faults.
fn run_beside(frame: Frame, guess: i32, st: vec2f, z: f32, slack: f32) -> Beside {
    let weights = ring_weights(st);
    var run = run_around(frame.column, clamp(guess, 0, frame.column.count - 2));
    var high = dot(weights, surface_z(frame, run.first));
    var low = dot(weights, surface_z(frame, run.last + 1));
    loop {
        let up = z > high + slack;
        let down = z < low - slack;
        if (!(up || down)) {
            break;
        }
        let layer = select(run.last + 1, run.first - 1, up);
        if (layer < 0 || layer + 1 >= frame.column.count) {
            return Beside(false, run, 0.0);
        }
        run = run_from(frame.column, layer, down);
        let z_new = dot(weights, surface_z(frame, select(run.last + 1, run.first, up)));
        let kept = low;
        low = select(z_new, high, up);
        high = select(kept, z_new, up);
    }
    return Beside(true, run, saturate((high - z) / max(high - low, 1e-20)));
}
