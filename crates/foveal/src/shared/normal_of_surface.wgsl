// The normal seen at a texel, world space: the surface's, bumps included.

#import shared/layers.wgsl
#import shared/surface.wgsl
#expects gbuffer_surface

// Cosine of the angle from which on two normals are two surfaces': 60 degrees, as surfaces may be
// bumpy.
const SAME_NORMAL: f32 = 0.5;

fn normal_seen(texel: vec2u) -> vec3f {
    return unit_from_octahedral(unpack2x16snorm(load_words(gbuffer_surface, texel).y));
}
