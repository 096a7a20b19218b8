// A pixel's further surface: its texel's place in the picture comes with it.

#import antialias/quarters.wgsl
#import shared/layers.wgsl
#expects identity

fn covered_by(texel: vec2u) -> vec2u {
    return vec2u(1u);
}

fn extent_of(texel: vec2u) -> vec2u {
    return vec2u(1u);
}

fn center_of(texel: vec2u) -> vec2f {
    return unpack_quarters(load_words(identity, texel).y);
}
