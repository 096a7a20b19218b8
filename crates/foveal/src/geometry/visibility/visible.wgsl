// Which triangle is seen at each pixel.

#import shared/frame.wgsl
#import shared/instances.wgsl
#import shared/material_at.wgsl
#import shared/material_bindings.wgsl
#import shared/vertex.wgsl

// Alpha cuts holes; without, the depth test may run before the shader.
override MASKED: bool = false;

struct VisibleVertex {
    @invariant @builtin(position) clip: vec4f,
    @location(0) uv: vec4f,
    @location(1) alpha: f32,
    // The instance's number; the highest bit tells the eye.
    @location(2) @interpolate(flat) instance: u32,
    // As `VertexOut`'s.
    @location(3) now: vec3f,
    @location(4) before: vec4f,
    // Within its mesh; only where vertices are pulled.
    @location(5) @interpolate(flat) triangle: u32,
}

struct VisibleOut {
    // `shared/identity.wgsl`.
    @location(0) identity: vec2u,
    @location(1) triangle: u32,
}

fn visible_vertex(d: Drawn, position: vec3f, previous_position: vec3f, uv: vec4f, alpha: f32) -> VisibleVertex {
    let i = instance_at(d.instance);
    let clip = frame.views[d.view].clip_from_world * vec4f(instance_position(i, position), 1.0);
    let before = clip_before(i, d.view, clip.xyw, position, previous_position);
    let marked = d.instance | (d.view << 31u);
    return VisibleVertex(in_target(clip, d.view), uv, alpha, marked, clip.xyw, before, 0u);
}

fn visible(in: VisibleVertex, triangle: u32) -> VisibleOut {
    if MASKED && alpha_at(in.uv, in.alpha) < material.alpha_cutoff {
        discard;
    }
    if is_beyond(in.now, in.instance) {
        discard;
    }
    return VisibleOut(identity_of(in.instance, in.now, in.before), triangle);
}
