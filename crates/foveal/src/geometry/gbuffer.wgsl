// Geometry pass: what is seen at each pixel.

#variant
#variant CLIPPED
#variant LAYERED
#import shared/below_lobes.wgsl
#import shared/face_normal.wgsl
#import shared/material_at.wgsl
#import shared/material_bindings.wgsl
#import shared/surface.wgsl
#import shared/vertex.wgsl

// Alpha cuts holes; without, the depth test may run before the shader.
override MASKED: bool = false;
// The triangle's own normal goes into the spare bits of the surface: anti-aliasing tells planes
// apart by it.
override FACE_NORMAL: bool = false;

struct GBufferOut {
    @location(0) surface: vec4u,
    // `shared/identity.wgsl`.
    @location(1) identity: vec2u,
}

@fragment
fn fragment(in: VertexOut, @builtin(front_facing) front: bool) -> GBufferOut {
    // Derivatives come first: a discarded neighbour has none.
    let face = cross(dpdx(in.world), dpdy(in.world));
    let m = material_at(in.world, in.normal, in.tangent, in.uv, in.color, front);
    if (MASKED && m.alpha < material.alpha_cutoff) || is_beyond(in.now, in.instance) {
        discard;
    }
    var words = pack_surface(below_lobes(m.surface, material.without_lobes));
    if FACE_NORMAL {
        words = with_face_normal(words, unit_or(face, m.surface.normal));
    }
    return GBufferOut(
        words,
        identity_of(in.instance, in.now, in.before),
    );
}
