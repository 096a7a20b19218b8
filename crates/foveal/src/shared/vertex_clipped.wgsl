// The vertex shader with a clip plane between the eyes' parts of the target. After vertex.wgsl; a module begins with
// `enable clip_distances`.

// `VertexOut` with the plane.
struct ClippedVertexOut {
    @invariant @builtin(position) clip: vec4f,
    @builtin(clip_distances) inside_own_half: array<f32, 1>,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec4f,
    @location(3) uv: vec4f,
    @location(4) color: vec4f,
    @location(5) @interpolate(flat) instance: u32,
    @location(6) now: vec3f,
    @location(7) before: vec3f,
}

@vertex
fn vertex_clipped(in: VertexIn) -> ClippedVertexOut {
    let v = vertex_of(in, drawn_as(in.drawn_index));
    // A little beyond the middle, so that rounding takes no pixel away, and less than any sub-sample lies beyond it.
    let slack = v.now.z / (64.0 * frame.size.x);
    let inside = array<f32, 1>(inside_own_half(v.now, v.instance) + slack);
    return ClippedVertexOut(
        v.clip, inside, v.world, v.normal, v.tangent, v.uv, v.color, v.instance, v.now, v.before,
    );
}
