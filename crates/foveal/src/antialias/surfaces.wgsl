// Which sub-samples of a pixel see the same surface, and what they see together. After samples.wgsl.
// CPU twin: `antialias/twin.rs`; nothing here needs a root or a transcendental function, so that it is exact.

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
    // View space.
    position: vec3f,
    // World space, any length.
    normal: vec3f,
}

// The face normal's octahedral map, in 127ths and not normalized.
fn face_normal(word: u32) -> vec3f {
    let e = vec2f(vec2i(i32(word << 8u) >> 24u, i32(word) >> 24u));
    let z = 127.0 - abs(e.x) - abs(e.y);
    return vec3f(select((127.0 - abs(e.yx)) * sign_not_zero(e), e, z >= 0.0), z);
}

fn facet_at(pixel: vec2u, index: u32) -> Facet {
    let texel = sample_texel(pixel, index);
    let instance = textureLoad(sample_identity, texel, 0).x;
    if instance == 0u {
        return Facet(0u, vec3f(0.0), vec3f(0.0));
    }
    let distance = view_distance(textureLoad(gbuffer_depth, texel, 0));
    let position = view_position(sample_position(pixel, index), distance);
    return Facet(instance, position, face_normal(textureLoad(gbuffer_surface, texel, 0).w));
}

fn same_surface(view: u32, a: Facet, b: Facet) -> bool {
    if a.instance != b.instance {
        return false;
    }
    if a.instance == 0u {
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

// What some sub-samples see on average.
struct Blend {
    words: vec4u,
    depth: f32,
    // In pixels of the frame.
    position: vec2f,
}

fn blend_of(pixel: vec2u, members: u32) -> Blend {
    let first_texel = sample_texel(pixel, firstTrailingBit(members));
    if textureLoad(sample_identity, first_texel, 0).x == 0u {
        return Blend(vec4u(0u), 0.0, vec2f(pixel) + 0.5);
    }
    var sum = Surface(vec3f(0.0), vec3f(0.0), vec3f(0.0), 0.0, 0.0, 0.0, vec3f(0.0));
    var depth = 0.0;
    var position = vec2f(0.0);
    for (var left = members; left != 0u; left &= left - 1u) {
        let index = firstTrailingBit(left);
        let texel = sample_texel(pixel, index);
        // Without the face normal.
        let words = textureLoad(gbuffer_surface, texel, 0) & vec4u(vec3u(0xffffffffu), 0xffffu);
        let s = unpack_surface(words, vec3f(0.0));
        sum.normal += s.normal;
        sum.base_color += s.base_color;
        sum.metallic += s.metallic;
        sum.roughness += s.roughness;
        sum.occlusion += s.occlusion;
        sum.emissive += s.emissive;
        depth += textureLoad(gbuffer_depth, texel, 0);
        position += sample_position(pixel, index);
    }
    let part = 1.0 / f32(countOneBits(members));
    let mean = Surface(
        vec3f(0.0),
        // Opposite normals may cancel: then any is as good.
        sum.normal + vec3f(0.0, 1e-6, 0.0),
        sum.base_color * part,
        sum.metallic * part,
        sum.roughness * part,
        sum.occlusion * part,
        sum.emissive * part,
    );
    var words = pack_surface(mean);
    let color = vec3u(round(sqrt(saturate(mean.base_color)) * 4080.0));
    words.x = (words.x & 0xff000000u) | (color.r >> 4u) | ((color.g >> 4u) << 8u) | ((color.b >> 4u) << 16u);
    words.w |= ((color.r & 15u) << 16u) | ((color.g & 15u) << 20u) | ((color.b & 15u) << 24u);
    return Blend(words, depth * part, position * part);
}
