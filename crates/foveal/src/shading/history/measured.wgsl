// How far samples lie from what was expected, tile by tile.

#expects measured

// The largest of a tile, as bits of floats: of all samples, and of those whose own light was kept.
struct Measured {
    error: atomic<u32>,
    change: atomic<u32>,
}

// Luminance, by display white, below which a difference counts as relative to this.
const DARK: f32 = 0.05;

fn measure(tile: u32, found: f32, expected: f32, is_own: bool) {
    let error = bitcast<u32>(abs(found - expected) / (max(found, expected) + DARK));
    atomicMax(&measured[tile].error, error);
    if is_own {
        atomicMax(&measured[tile].change, error);
    }
}
