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

// Second coordinate of the Sobol sequence for an index below 2^16. Its directions are the rows of
// Pascal's triangle modulo 2: bit j, from the top, is the sum of the index's bits k of which j is a
// subset (Lucas), which four folds give for all j at once.
fn sobol_second(index: u32) -> u32 {
    var x = index & 0xffffu;
    x ^= (x >> 1u) & 0x5555u;
    x ^= (x >> 2u) & 0x3333u;
    x ^= (x >> 4u) & 0x0f0fu;
    x ^= (x >> 8u) & 0x00ffu;
    return reverseBits(x);
}

// Point `index` of a pair of dimensions, for a pixel's own seed.
fn sobol_point(index: u32, pair: u32, seed: u32) -> vec2f {
    let own = hash(seed ^ hash(pair));
    let shuffled = owen_scramble(index, own);
    let x = owen_scramble(reverseBits(shuffled & 0xffffu), hash(own + 1u));
    let y = owen_scramble(sobol_second(shuffled), hash(own + 2u));
    return vec2f(unit_float(x), unit_float(y));
}
