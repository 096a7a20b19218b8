// Sub-samples that are known by their triangles alone.

#import antialias/samples.wgsl
#import antialias/surfaces.wgsl
#import shared/attributes.wgsl
#import shared/frame.wgsl
#import shared/instances.wgsl
#import shared/places.wgsl
#import shared/vertex.wgsl

@group(1) @binding(0) var<uniform> band: Band;
@group(1) @binding(1) var sample_identity: texture_2d<u32>;
@group(1) @binding(2) var sample_triangle: texture_2d<u32>;
@group(1) @binding(3) var sample_depth: texture_depth_2d;

// Instance number + 1 and triangle.
fn id_at(pixel: vec2u, index: u32) -> vec2u {
    let texel = sample_texel(pixel, index);
    return vec2u(textureLoad(sample_identity, texel, 0).x, textureLoad(sample_triangle, texel, 0).x);
}

fn depth_at(pixel: vec2u, index: u32) -> f32 {
    return textureLoad(sample_depth, sample_texel(pixel, index), 0);
}

// What was looked up once for a pixel: its triangles' corners are dear.
var<private> known: array<Facet, 16>;

fn facet_at(pixel: vec2u, index: u32) -> Facet {
    return known[index];
}

fn look_up_facet(pixel: vec2u, index: u32) -> Facet {
    let id = id_at(pixel, index);
    if id.x == 0u {
        return Facet(0u, 0u, vec3f(0.0), vec3f(0.0));
    }
    let position = view_position(sample_position(pixel, index), view_distance(depth_at(pixel, index)));
    let i = instance_at(id.x - 1u);
    let place = place_of(id.x - 1u);
    let first = place.first_index + id.y * 3u;
    let a = instance_position(i, corner_position(place.base_vertex + index_at(first)));
    let b = instance_position(i, corner_position(place.base_vertex + index_at(first + 1u)));
    let c = instance_position(i, corner_position(place.base_vertex + index_at(first + 2u)));
    let whole = cross(b - a, c - a);
    // Products of four of these stay in range, whatever the triangle's size.
    let face = whole / max(max(abs(whole.x), max(abs(whole.y), abs(whole.z))), 1e-37);
    let toward = dot(face, direction_to_eye(view_of(pixel), a)) >= 0.0;
    return Facet(id.x, id.y, position, select(-face, face, toward));
}

fn corner_position(vertex: u32) -> vec3f {
    return bitcast<vec3f>(vertex_row(vertex * 4u).xyz);
}

// Mean position of some sub-samples in pixels of the frame, and their mean depth: that at the
// position, on a plane.
fn center_of_members(pixel: vec2u, members: u32) -> vec3f {
    var sum = vec3f(0.0);
    // All are looked at: a loop of one length for all lanes is unrolled, one over the members is
    // not.
    for (var i = 0u; i < COUNT; i++) {
        let at = vec3f(sample_position(pixel, i), depth_at(pixel, i));
        sum += select(vec3f(0.0), at, ((members >> i) & 1u) != 0u);
    }
    return sum / f32(countOneBits(members));
}
