// For devices that do not number triangles, or take long to: an index names a triangle's first
// corner, or a vertex. Rust: `scene/provoking.rs`.

#variant
#variant LAYERED
#import geometry/visibility/visible.wgsl
#import shared/attributes.wgsl
#import shared/instances.wgsl
#import shared/places.wgsl
#import shared/vertex.wgsl

@vertex
fn vertex_pulled(@builtin(instance_index) drawn_index: u32, @builtin(vertex_index) at: u32) -> VisibleVertex {
    return pulled_vertex(drawn_as(drawn_index), at);
}

fn pulled_vertex(d: Drawn, at: u32) -> VisibleVertex {
    let place = place_of(d.instance);
    let number = at >> 1u;
    let vertex = select(place.base_vertex + index_at(number * 3u), number, (at & 1u) != 0u);
    let corner = corner_at(vertex);
    let previous = bitcast<vec3f>(previous_vertex_row(vertex * 4u).xyz);
    var out = visible_vertex(d, corner.position, previous, corner.uv, corner.color.a);
    // Counts only at a triangle's first corner, where it is taken from.
    out.triangle = number - place.first_index / 3u;
    return out;
}

@fragment
fn visible_pulled(in: VisibleVertex) -> VisibleOut {
    return visible(in, in.triangle);
}

#ifdef LAYERED
// Run once for each layer of the target; a layer is an eye's.
@vertex
fn vertex_pulled_layered(
    @builtin(instance_index) drawn_index: u32,
    @builtin(vertex_index) at: u32,
    @builtin(view_index) view: u32,
) -> VisibleVertex {
    return pulled_vertex(Drawn(drawn_at(drawn_index), view), at);
}
#endif
