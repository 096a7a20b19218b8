// Which sub-samples of a pixel see the same surface. CPU twin: `antialias/twin.rs`; nothing here
// needs a root or a transcendental function, so that it is exact.

#import antialias/samples.wgsl
#import shared/frame.wgsl
#expects facet_at

// Steps off the plane that still count as on it: this part of a pixel's side at that distance,
const PLANE_PIXELS: f32 = 0.5;
// and this part of the distance between the two points, for curvature and the normal's 8 bits.
const PLANE_SLOPE: f32 = 0.03;
// Squared cosine of the largest angle between the triangles' normals: 30 degrees.
const CREASE: f32 = 0.75;

// What one sub-sample knows of its surface.
struct Facet {
    // Instance number + 1; 0 = nothing.
    instance: u32,
    // Equal only where one triangle is seen; else any number of the sub-sample's own.
    triangle: u32,
    // View space.
    position: vec3f,
    // World space, any length.
    normal: vec3f,
}

fn same_surface(view: u32, a: Facet, b: Facet) -> bool {
    if a.instance != b.instance {
        return false;
    }
    if a.instance == 0u || a.triangle == b.triangle {
        return true;
    }
    let ab = dot(a.normal, b.normal);
    let aa = dot(a.normal, a.normal);
    if ab <= 0.0 || ab * ab < CREASE * aa * dot(b.normal, b.normal) {
        return false;
    }
    let step = b.position - a.position;
    // To view space: the rotation's transpose.
    let world_from_view = frame.views[view].world_from_view;
    let normal = vec3f(
        dot(world_from_view[0].xyz, a.normal),
        dot(world_from_view[1].xyz, a.normal),
        dot(world_from_view[2].xyz, a.normal),
    );
    let off = dot(normal, step);
    let pixel_side = 2.0 * frame.views[view].view_from_ndc.y / frame.size.y
        * select(-a.position.z, 1.0, frame.orthographic != 0u);
    let tolerance = PLANE_PIXELS * PLANE_PIXELS * pixel_side * pixel_side
        + PLANE_SLOPE * PLANE_SLOPE * dot(step, step);
    return off * off <= tolerance * aa;
}

// The sub-samples in `candidates` that see the surface of the first of them, as bits.
fn surface_of_first(pixel: vec2u, candidates: u32) -> u32 {
    let first = firstTrailingBit(candidates);
    let leader = facet_at(pixel, first);
    var members = 1u << first;
    for (var others = candidates & (candidates - 1u); others != 0u; others &= others - 1u) {
        let index = firstTrailingBit(others);
        if same_surface(view_of(pixel), leader, facet_at(pixel, index)) {
            members |= 1u << index;
        }
    }
    return members;
}

fn all_samples() -> u32 {
    // More than 16 are never sorted into surfaces; the shift must be valid all the same.
    return (1u << min(COUNT, 16u)) - 1u;
}

// The largest of the pixel's surfaces as bits (the earliest of equals), and how many there are.
fn largest_surface(pixel: vec2u) -> vec2u {
    var largest = 0u;
    var surfaces = 0u;
    for (var left = all_samples(); left != 0u;) {
        let members = surface_of_first(pixel, left);
        left &= ~members;
        surfaces += 1u;
        if countOneBits(members) > countOneBits(largest) {
            largest = members;
        }
    }
    return vec2u(largest, surfaces);
}
