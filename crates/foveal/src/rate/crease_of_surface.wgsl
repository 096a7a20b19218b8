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
// right and to that below, as the sum of one minus each cosine, and what is added to the width.
// Both found by measurement.
const BUMP: f32 = 0.1;
const LEAST_WIDTH: f32 = 0.01;

// Whether normals turn within a block of 2 x 2 pixels by so much that light which one pixel
// mirrors says little about its neighbours'.
fn is_bumpy(first: vec2i, last: vec2i) -> bool {
    let normal = normal_at(first);
    let right = normal_at(min(first + vec2i(1, 0), last));
    let down = normal_at(min(first + vec2i(0, 1), last));
    let roughness = unpack4x8unorm(load_words(gbuffer_surface, vec2u(first)).w).y;
    let a2 = roughness * roughness * roughness * roughness;
    return 2.0 - dot(normal, right) - dot(normal, down) > BUMP * (a2 + LEAST_WIDTH);
}
