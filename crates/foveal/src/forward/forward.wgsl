// Forward pass for blended surfaces, back to front over the deferred picture.
// After frame, surface, vertex, material, lighting and lights.wgsl.

// Each eye is drawn to a layer of its own.
override LAYERED: bool = false;
// Drawn at sub-samples: what is drawn to has other texels than the picture.
override SAMPLED: bool = false;

// A fragment's position in pixels of the target.
fn target_position(in: VertexOut) -> vec2f {
    let right = (in.instance & RIGHT_EYE) != 0u;
    if SAMPLED {
        let in_picture = (in.now.xy / in.now.z * vec2f(0.5, -0.5) + 0.5) * frame.size;
        return in_picture + vec2f(select(0.0, f32(frame.eye_stride), right), 0.0);
    }
    let beside = LAYERED && right;
    return in.clip.xy + vec2f(select(0.0, f32(frame.eye_stride), beside), 0.0);
}

@fragment
fn fragment(in: VertexOut, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    let m = material_at(in.world, in.normal, in.tangent, in.uv, in.color, front);
    if is_beyond(in.now, in.instance) {
        discard;
    }
    let pixel = target_position(in);
    let view = frame.views[view_at(pixel)];
    let distance = dot(in.world - view.world_from_view[3].xyz, view.forward);
    let radiance = min(lit(m.surface, pixel, distance), vec3f(65504.0));
    let alpha = saturate(m.alpha);
    // Premultiplied.
    return vec4f(radiance * alpha, alpha);
}
