// Geometry pass: what is seen at each pixel. After frame, surface, vertex and material.wgsl.

// Alpha cuts holes; without, the depth test may run before the shader.
override MASKED: bool = false;

struct GBufferOut {
    @location(0) surface: vec4u,
    // x: instance number + 1 (0 = nothing); y: motion in pixels since the frame before, two halves.
    @location(1) identity: vec2u,
}

fn motion_in_pixels(now: vec3f, before: vec3f) -> vec2f {
    let moved = now.xy / now.z - before.xy / before.z;
    return clamp(moved * vec2f(0.5, -0.5) * frame.size, vec2f(-60000.0), vec2f(60000.0));
}

@fragment
fn fragment(in: VertexOut, @builtin(front_facing) front: bool) -> GBufferOut {
    let m = material_at(in.world, in.normal, in.tangent, in.uv, in.color, front);
    if MASKED && m.alpha < material.alpha_cutoff {
        discard;
    }
    return GBufferOut(
        pack_surface(m.surface),
        vec2u(in.instance + 1u, pack2x16float(motion_in_pixels(in.now, in.before))),
    );
}
