// Parameters of a frame's passes. Rust: `HistoryParameters` in `shading/history/passes.rs`.

#expects parameters

// A uniform, on which no branch may hang alone (ARCHITECTURE.md).
struct HistoryParameters {
    // Added to a place before it is rounded to whole pixels; -0.5 to 0.5, another one each frame.
    rounding: vec2f,
    // Added to the pixels' order of renewal; another one each frame.
    phase: u32,
    // 1: nothing is kept.
    reset: u32,
    // Samples a frame for each block, by which a block's light is renewed while nothing changes.
    renewal: f32,
    // Relative error of what is kept from which on it is renewed more often.
    tolerance: f32,
    // Relative change of a pixel's light from which on what is kept around it counts no more.
    change: f32,
    // 1: each pixel's light was sampled at its own place, whatever its notes say.
    whole_round: u32,
}
