// Creases between blocks of 2 x 2 pixels, and bumps within them, by their surfaces' normals. CPU
// twin of the bumps: `rate/bumps.rs`.

#import shared/layers.wgsl
#import shared/surface.wgsl
#expects gbuffer_surface

fn normal_at(texel: vec2i) -> vec3f {
    return unit_from_octahedral(unpack2x16snorm(load_words(gbuffer_surface, vec2u(texel)).y));
}

// Whether a block's surface turns by more than 45 degrees towards the block to its right or below.
// `first` is its upper left pixel, `last` the picture's last.
fn turns(first: vec2i, last: vec2i) -> bool {
    let normal = normal_at(first);
    let right = normal_at(vec2i(min(first.x + 2, last.x), first.y));
    let down = normal_at(vec2i(first.x, min(first.y + 2, last.y)));
    return min(dot(normal, right), dot(normal, down)) < 0.7;
}

// Part of a highlight's width, the squared alpha, by which the normal may turn to the pixel on the
// right and to that below, as the sum of one minus each cosine, and what is added to the width: for
// dielectrics, which scatter most light, and for metals. Found by measurement.
const BUMP: f32 = 0.1;
const LEAST_WIDTH: f32 = 0.01;
const LEAST_METAL_WIDTH: f32 = 0.0005;
// The turn of a metal that is sharp: by so many times what may be.
const SHARP: f32 = 16.0;

// How normals turn within a block of 2 x 2 pixels: 1 where light that one pixel mirrors says little
// about its neighbours', 2 on metals where it says nothing, else 0.
fn bumpiness(first: vec2i, last: vec2i) -> u32 {
    let normal = normal_at(first);
    let right = normal_at(min(first + vec2i(1, 0), last));
    let down = normal_at(min(first + vec2i(0, 1), last));
    let factors = unpack4x8unorm(load_words(gbuffer_surface, vec2u(first)).w);
    let metallic = factors.x;
    let a2 = factors.y * factors.y * factors.y * factors.y;
    let turn = 2.0 - dot(normal, right) - dot(normal, down);
    let allowed = BUMP * (a2 + mix(LEAST_WIDTH, LEAST_METAL_WIDTH, metallic));
    return u32(turn > allowed) + u32(turn * metallic > SHARP * allowed);
}
