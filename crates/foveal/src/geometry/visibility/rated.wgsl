// A sample's upper left pixel stands for all of its pixels.

#import shading/variable/rates.wgsl
#expects mask

fn rate_at(quad: vec2u) -> u32 {
    return textureLoad(mask, quad, 0).x & RATE;
}

fn has_listed(quad: vec2u, rate: u32) -> bool {
    return true;
}

fn is_listed(texel: vec2u, rate: u32) -> bool {
    return stands_for_sample(texel, rate);
}

fn is_read(texel: vec2u, rate: u32) -> bool {
    return true;
}

fn covered_by(texel: vec2u) -> vec2u {
    return extent_of(texel);
}

fn extent_of(texel: vec2u) -> vec2u {
    return extent_at(textureLoad(mask, texel / 2u, 0).x & RATE);
}

// The sample's centre, in texels.
fn center_of(texel: vec2u) -> vec2f {
    return vec2f(texel) + 0.5 * vec2f(extent_of(texel));
}
