// Both eyes to layers of their own. After trial.wgsl.

@vertex
fn eyes_layered(
    @builtin(instance_index) drawn: u32,
    @builtin(vertex_index) vertex: u32,
    @builtin(view_index) view: u32,
) -> Corner {
    return corner(drawn, vertex, view);
}
