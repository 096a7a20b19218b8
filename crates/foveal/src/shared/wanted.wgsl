// Pixels that are to be shaded, once each: a bit for each pixel, row by row.

#import shared/frame.wgsl
#expects wanted

// Whether nobody wanted this pixel shaded before.
fn is_first_to_want(texel: vec2u) -> bool {
    let number = texel.y * u32(frame.target_size.x) + texel.x;
    let bit = 1u << (number & 31u);
    return (atomicOr(&wanted[number >> 5u], bit) & bit) == 0u;
}
