// What the rasterizer would have interpolated at a point of a triangle, without the rasterizer.
// Rust: `scene/geometry.rs`.
//
// Barycentric coordinates in homogeneous screen space (Olano and Greer 1997, 'Triangle scan
// conversion using 2D homogeneous coordinates'): no vertex is divided by its w, so that triangles
// may pass beside and behind the eye. Derivatives are those of the same quotient, as in Burns and
// Hunt 2013, 'The visibility buffer', and Schied and Dachsbacher 2015, 'Deferred attribute
// interpolation for memory-efficient deferred shading'.

#ifdef TABLES
#import gpu/table.wgsl
#endif
#import shared/instances.wgsl
#import shared/places.wgsl
#import shared/vertex.wgsl

// A vertex in four words each of four: position, normal, tangent, both UV sets, colour.
#ifdef TABLES
@group(2) @binding(0) var vertices: texture_2d<u32>;
// The same in the pose of the frame before.
@group(2) @binding(1) var previous_vertices: texture_2d<u32>;
@group(2) @binding(2) var indices: texture_2d<u32>;
// Of each instance.
@group(2) @binding(3) var place_table: texture_2d<u32>;

// Four of a vertex's sixteen words.
fn vertex_row(row: u32) -> vec4u {
    return textureLoad(vertices, table_texel(row), 0);
}

fn previous_vertex_row(row: u32) -> vec4u {
    return textureLoad(previous_vertices, table_texel(row), 0);
}

fn index_at(i: u32) -> u32 {
    let words = textureLoad(indices, table_texel(i / 4u), 0);
    return words[i % 4u];
}
#else
@group(2) @binding(0) var<storage, read> vertices: array<vec4u>;
// The same in the pose of the frame before.
@group(2) @binding(1) var<storage, read> previous_vertices: array<vec4u>;
@group(2) @binding(2) var<storage, read> indices: array<u32>;
// Of each instance.
@group(2) @binding(3) var<storage, read> places: array<Place>;

// Four of a vertex's sixteen words.
fn vertex_row(row: u32) -> vec4u {
    return vertices[row];
}

fn previous_vertex_row(row: u32) -> vec4u {
    return previous_vertices[row];
}

fn index_at(i: u32) -> u32 {
    return indices[i];
}
#endif

struct Corner {
    position: vec3f,
    normal: vec3f,
    tangent: vec4f,
    uv: vec4f,
    color: vec4f,
}

fn corner_at(vertex: u32) -> Corner {
    let a = vertex_row(vertex * 4u);
    let b = vertex_row(vertex * 4u + 1u);
    let c = vertex_row(vertex * 4u + 2u);
    let d = vertex_row(vertex * 4u + 3u);
    return Corner(
        bitcast<vec3f>(a.xyz),
        bitcast<vec3f>(vec3u(a.w, b.xy)),
        bitcast<vec4f>(vec4u(b.zw, c.xy)),
        bitcast<vec4f>(vec4u(c.zw, d.xy)),
        vec4f(unpack2x16unorm(d.z), unpack2x16unorm(d.w)),
    );
}

struct Barycentrics {
    // Of the three corners; their sum is 1.
    at: vec3f,
    // Change per pixel to the right and per pixel down.
    right: vec3f,
    down: vec3f,
    // The corners run counter-clockwise on the screen.
    counter_clockwise: bool,
}

// From a point to the triangle, in steps to the right and down: nowhere from within, else to the line of the
// edge beyond which the point lies farthest. `areas` lie between the point and each edge, `right` and `down`
// are their changes per step; `side` is the sign that they have within.
fn toward(areas: vec3f, right: vec3f, down: vec3f, side: f32) -> vec2f {
    let per_step = inverseSqrt(max(right * right + down * down, vec3f(1e-37)));
    let distances = side * areas * per_step;
    let least = min(distances.x, min(distances.y, distances.z));
    let edge = select(select(2u, 1u, distances.y == least), 0u, distances.x == least);
    let beyond = select(-least, 0.0, all(areas >= vec3f(0.0)) || all(areas <= vec3f(0.0)));
    return vec2f(right[edge], down[edge]) * (side * per_step[edge] * beyond);
}

// Perspective-correct barycentric coordinates, for corners given as x, y, w of clip space, at a
// point in normalized device coordinates; `step` is a pixel's size in these, down being negative.
//
// A point outside is moved to the triangle: the rasterizer snaps corners to a grid, anti-aliasing asks for a
// pixel's centre where the triangle may not reach it, and shading rates for the centre of several pixels.
// Coordinates that were only cut at 0 would, in a triangle thinner than a pixel, be those of a place far away.
fn barycentrics_at(a: vec3f, b: vec3f, c: vec3f, ndc: vec2f, step: vec2f) -> Barycentrics {
    // Moving the point to the origin first keeps small triangles precise.
    let p = a.xy - ndc * a.z;
    let q = b.xy - ndc * b.z;
    let r = c.xy - ndc * c.z;
    let areas_there = vec3f(q.x * r.y - q.y * r.x, r.x * p.y - r.y * p.x, p.x * q.y - p.y * q.x);
    let areas_right = step.x * vec3f(q.y * c.z - r.y * b.z, r.y * a.z - p.y * c.z, p.y * b.z - q.y * a.z);
    let areas_down = step.y * vec3f(r.x * b.z - q.x * c.z, p.x * c.z - r.x * a.z, q.x * a.z - p.x * b.z);
    // The sign of the areas' sum, but for points above the plane's horizon.
    let side = select(-1.0, 1.0, dot(areas_there, vec3f(a.z, b.z, c.z)) >= 0.0);
    let moved = toward(areas_there, areas_right, areas_down, side);
    let areas = areas_there + areas_right * moved.x + areas_down * moved.y;
    let one = vec3f(1.0);
    let sum = dot(areas, one);
    let inverse = select(1.0 / sum, 0.0, sum == 0.0);
    let at = areas * inverse;
    let right = (areas_right - at * dot(areas_right, one)) * inverse;
    let down = (areas_down - at * dot(areas_down, one)) * inverse;
    let inside = max(at, vec3f(0.0));
    let rest = dot(inside, one);
    return Barycentrics(select(inside / rest, one / 3.0, rest == 0.0), right, down, sum > 0.0);
}

struct Attributes {
    // World space.
    position: vec3f,
    // Not unit: interpolated.
    normal: vec3f,
    tangent: vec4f,
    // Both UV sets, and their change per pixel to the right and per pixel down.
    uv: vec4f,
    uv_right: vec4f,
    uv_down: vec4f,
    color: vec4f,
    front: bool,
    // Of the triangle; away from the eye, of any length.
    face: vec3f,
}

// The attributes of a triangle (counted within its mesh) of an instance at a point in normalized
// device coordinates.
fn attributes_at(clip_from_world: mat4x4f, instance: u32, triangle: u32, ndc: vec2f, step: vec2f) -> Attributes {
    let i = instance_at(instance);
    let place = place_of(instance);
    let first = place.first_index + triangle * 3u;
    let a = corner_at(place.base_vertex + index_at(first));
    let b = corner_at(place.base_vertex + index_at(first + 1u));
    let c = corner_at(place.base_vertex + index_at(first + 2u));
    let wa = world_vertex(i, a.position, a.normal, a.tangent);
    let wb = world_vertex(i, b.position, b.normal, b.tangent);
    let wc = world_vertex(i, c.position, c.normal, c.tangent);
    let bary = barycentrics_at(
        (clip_from_world * vec4f(wa.position, 1.0)).xyw,
        (clip_from_world * vec4f(wb.position, 1.0)).xyw,
        (clip_from_world * vec4f(wc.position, 1.0)).xyw,
        ndc,
        step,
    );
    let at = bary.at;
    let face = cross(wb.position - wa.position, wc.position - wa.position);
    return Attributes(
        wa.position * at.x + wb.position * at.y + wc.position * at.z,
        wa.normal * at.x + wb.normal * at.y + wc.normal * at.z,
        wa.tangent * at.x + wb.tangent * at.y + wc.tangent * at.z,
        a.uv * at.x + b.uv * at.y + c.uv * at.z,
        a.uv * bary.right.x + b.uv * bary.right.y + c.uv * bary.right.z,
        a.uv * bary.down.x + b.uv * bary.down.y + c.uv * bary.down.z,
        a.color * at.x + b.color * at.y + c.color * at.z,
        bary.counter_clockwise == (handedness_of(i) > 0.0),
        select(face, -face, bary.counter_clockwise),
    );
}
