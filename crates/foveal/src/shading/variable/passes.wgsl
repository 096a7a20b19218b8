// What the passes that find rates are told, read and write. Rust: `shading/variable/passes.rs`.

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

@group(1) @binding(1) var<uniform> rates: Rates;
@group(1) @binding(2) var identity: texture_2d_array<u32>;
@group(1) @binding(3) var depth: texture_depth_2d_array;
// Of the frame before: what was known of its quads, its picture.
@group(1) @binding(4) var before: texture_2d<u32>;
@group(1) @binding(5) var picture_before: texture_2d<f32>;
// What a pass before this one has reprojected.
@group(1) @binding(6) var reprojected: texture_2d<u32>;
@group(1) @binding(7) var known: texture_storage_2d<rg32uint, write>;
@group(1) @binding(8) var mask: texture_storage_2d<r32uint, write>;
