// Geometry pass without a depth texture that could be read: the second target holds the depth's
// bits where the full renderer's holds instance and motion, which nothing here asks for.

#variant REDUCED
#import shared/frame.wgsl
#import shared/material_at.wgsl
#import shared/material_bindings.wgsl
#import shared/surface.wgsl
#import shared/vertex.wgsl

// Alpha cuts holes; without, the depth test may run before the shader.
override MASKED: bool = false;

struct GBufferOut {
    @location(0) surface: vec4u,
    @location(1) depth: vec2u,
}

@fragment
fn fragment(in: VertexOut, @builtin(front_facing) front: bool) -> GBufferOut {
    let m = material_at(in.world, in.normal, in.tangent, in.uv, in.color, front);
    if (MASKED && m.alpha < material.alpha_cutoff) || is_beyond(in.now, in.instance) {
        discard;
    }
    // OpenGL's depth, from -1 to 1 on the way, would have lost what reversal gains.
    let depth = select(frame.near / in.now.z, in.clip.z, frame.orthographic != 0u);
    return GBufferOut(pack_surface(m.surface), vec2u(bitcast<u32>(depth), 0u));
}
