// What the passes that find rates are told. Rust: `shading/variable/passes.rs`, `RatesUniform`.

struct Rates {
    // Least relative contrast that is shaded in full.
    threshold: f32,
    // By what part the threshold grows per pixel of motion.
    velocity_gain: f32,
    // Quads whose number's bits under the mask are these are probed, x and y.
    probe_mask: u32,
    probe_x: u32,
    probe_y: u32,
    // 1: the frame before tells nothing.
    reset: u32,
    reserved_0: u32,
    reserved_1: u32,
}
