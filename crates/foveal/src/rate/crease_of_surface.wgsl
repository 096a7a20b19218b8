// Creases between blocks of 2 x 2 pixels, by their surfaces' normals.

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
