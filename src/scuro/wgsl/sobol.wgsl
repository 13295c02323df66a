// Points of the unit square for any number of dimensions: Sobol's (0, 2) sequence, its order and its
// digits scrambled anew for every pair of dimensions (Burley 2020, "Practical hash-based Owen
// scrambling"). Pairs are independent of each other, each by itself is stratified at all powers of 2.

//#include "sampling.wgsl"

fn owen_scramble(value: u32, seed: u32) -> u32 {
    var x = reverseBits(value);
    x += seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return reverseBits(x);
}

// Second coordinate of the Sobol sequence for an index below 2^16.
fn sobol_second(index: u32) -> u32 {
    var result = 0u;
    var digit = 0x80000000u;
    for (var rest = index & 0xffffu; rest != 0u; rest >>= 1u) {
        result ^= select(0u, digit, (rest & 1u) != 0u);
        digit ^= digit >> 1u;
    }
    return result;
}

// Point `index` of a pair of dimensions, for a pixel's own seed.
fn sobol_point(index: u32, pair: u32, seed: u32) -> vec2f {
    let own = hash(seed ^ hash(pair));
    let shuffled = owen_scramble(index, own);
    let x = owen_scramble(reverseBits(shuffled & 0xffffu), hash(own + 1u));
    let y = owen_scramble(sobol_second(shuffled), hash(own + 2u));
    return vec2f(unit_float(x), unit_float(y));
}
