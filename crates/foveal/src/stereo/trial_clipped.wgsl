// Both eyes side by side with a clip plane between them. After trial.wgsl; a module begins with
// `enable clip_distances`.

struct ClippedCorner {
    @invariant @builtin(position) clip: vec4f,
    @builtin(clip_distances) inside: array<f32, 1>,
    @location(0) @interpolate(flat) number: u32,
    @location(1) inside_own_half: f32,
}

@vertex
fn eyes_clipped(@builtin(instance_index) drawn: u32, @builtin(vertex_index) vertex: u32) -> ClippedCorner {
    let c = beside(drawn, vertex);
    // The plane alone decides.
    return ClippedCorner(c.clip, array<f32, 1>(c.inside_own_half), c.number, 1.0);
}
