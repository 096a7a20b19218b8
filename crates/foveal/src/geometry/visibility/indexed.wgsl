// The triangle's number comes from the device.

#variant
#variant LAYERED
enable primitive_index;
#import geometry/visibility/visible.wgsl
#import shared/instances.wgsl
#import shared/vertex.wgsl

struct VisibleIn {
    @builtin(instance_index) drawn_index: u32,
    @location(0) position: vec3f,
    @location(3) uv: vec4f,
    @location(4) color: vec4f,
    // Object space, in the pose of the frame before.
    @location(5) previous_position: vec3f,
}

@vertex
fn vertex_indexed(in: VisibleIn) -> VisibleVertex {
    return visible_vertex(drawn_as(in.drawn_index), in.position, in.previous_position, in.uv, in.color.a);
}

@fragment
fn visible_indexed(in: VisibleVertex, @builtin(primitive_index) triangle: u32) -> VisibleOut {
    return visible(in, triangle);
}

#ifdef LAYERED
// Run once for each layer of the target; a layer is an eye's.
@vertex
fn vertex_indexed_layered(in: VisibleIn, @builtin(view_index) view: u32) -> VisibleVertex {
    let d = Drawn(drawn_at(in.drawn_index), view);
    return visible_vertex(d, in.position, in.previous_position, in.uv, in.color.a);
}
#endif
