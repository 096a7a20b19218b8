// How far samples lie from what was expected, tile by tile.

// The largest of a tile, as bits of floats: of all samples, and of those whose own light was kept.
struct Measured {
    error: atomic<u32>,
    change: atomic<u32>,
}
