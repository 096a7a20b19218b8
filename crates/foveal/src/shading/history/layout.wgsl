// What is kept of each pixel and of each tile of 8 x 8 pixels from frame to frame. Rust:
// `shading/history/passes.rs`.

#import shared/frame.wgsl

// What a pixel keeps besides its light: the instance that is seen (12 bits of its number + 1), the
// level of the block that its light was sampled for (3 bits), two notes, and the distance's upper
// 15 bits as a rounded float, which is 0.4 % apart.
const SEEN_INSTANCE: u32 = 0xfffu;
const SEEN_LEVEL_SHIFT: u32 = 12u;
const SEEN_LEVEL: u32 = 7u;
// Something is kept.
const SEEN_AT_ALL: u32 = 0x8000u;
// The light was sampled at this place of the surface, not around it.
const SEEN_OWN: u32 = 0x10000u;
const SEEN_DISTANCE: u32 = 0xfffe0000u;

// Relative difference of distances that counts as the same surface.
const SAME_DISTANCE: f32 = 0.02;

fn distance_bits(distance: f32) -> u32 {
    return ((bitcast<u32>(distance) + 0x8000u) << 1u) & SEEN_DISTANCE;
}

fn distance_from_bits(bits: u32) -> f32 {
    return bitcast<f32>((bits & SEEN_DISTANCE) >> 1u);
}

// A tile of 8 x 8 pixels, in x and y of its texel.
struct TileHistory {
    // Relative error of what its samples were expected to be, the largest of late.
    error: f32,
    // The same of pixels whose own light was kept: nothing but time can have changed it.
    change: f32,
}

// Tiles across the target.
fn tiles_across() -> u32 {
    return (u32(frame.target_size.x) + 7u) / 8u;
}

fn tiles_down() -> u32 {
    return (u32(frame.target_size.y) + 7u) / 8u;
}

fn tile_number(texel: vec2u) -> u32 {
    return (texel.y / 8u) * tiles_across() + texel.x / 8u;
}

// A sample to be shaded: x: column and row in 14 bits each, and the level in 4; y: the luminance
// that is expected there, and what it is known from (below), as halves.
const EXPECTED_NOTHING: f32 = 0.0;
const EXPECTED_AROUND: f32 = 1.0;
const EXPECTED_OWN: f32 = 2.0;

fn sample_entry(texel: vec2u, level: u32) -> u32 {
    return texel.x | (texel.y << 14u) | (level << 28u);
}

fn entry_texel(entry: u32) -> vec2u {
    return vec2u(entry, entry >> 14u) & vec2u(0x3fffu);
}

// How long a list is, and how many of its samples are of each level.
struct Listed {
    count: atomic<u32>,
    of_level: array<atomic<u32>, 9>,
}

// A list's workgroups in x, y and z, and its length; as large as the step between bindings.
struct Dispatch {
    groups: vec3u,
    count: u32,
    reserved: array<vec4u, 15>,
}

// A thread's place in a list; workgroups have 64 threads, and `across` of them lie in a row.
fn list_index(group: vec3u, local: u32, across: u32) -> u32 {
    return (group.y * across + group.x) * 64u + local;
}

// The lists: samples of blocks (`of_level` counts single pixels as well); pixels that have no history;
// of these the ones that no sample speaks for; pixels that ask for a sample; pixels that are shaded by
// themselves; pixels that take their leader's light. The first and the fifth list share an array: single
// pixels stand from its beginning on, blocks from its end back. So do the fourth and, once that is read,
// from the end back the last.
const SAMPLES: u32 = 0u;
const BARE: u32 = 1u;
const UNLIT: u32 = 2u;
const CHOSEN: u32 = 3u;
const SINGLE: u32 = 4u;
const LED: u32 = 5u;
const LISTS: u32 = 6u;

// A choice: below this the level of the block whose sample a pixel waits for; else it is shaded by
// itself, and the rest says what the luminance that is expected there is known from.
const CHOSEN_ITSELF: u32 = 9u;

// A pixel's place in it: any share of the least numbers lies evenly in the picture (the additive
// recurrence by the plastic number: Roberts 2018, 'The Unreasonable Effectiveness of Quasirandom
// Sequences').
fn order_of(texel: vec2u) -> u32 {
    return texel.x * 3242174889u + texel.y * 2447445414u;
}
