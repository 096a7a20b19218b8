// A packed surface with its triangle's own normal, by which anti-aliasing tells planes apart.

#import shared/surface.wgsl

// With a triangle's own normal in the upper half of the last word. Where that holds bits of a
// dielectric, these go to the emissive as what emission never gives; a surface that glows keeps no
// dielectric, unless it is unlit: see below. Vertex normals are not kept.
fn with_face_normal(words: vec4u, face: vec3f) -> vec4u {
    let bits = dielectric_of(words);
    let is_own = (words.w & OWN_DIELECTRIC) != 0u;
    let moves = is_own && (words.z == 0u || is_no_glow(words.z));
    let moved = (31u << 27u) | (bits & 255u) | (((bits >> 8u) & 63u) << 9u);
    let upper = pack4x8snorm(vec4f(0.0, 0.0, octahedral_from_unit(face)));
    return vec4u(words.xy, select(words.z, moved, moves), (words.w & 0xffffu) | upper);
}

// The packed colour, occlusion, metallic and roughness of an unlit surface: none, none, none, full.
const UNLIT_COLOR: u32 = 0u;
const UNLIT_LOWER: u32 = 0xff00u;

// The surface without it. What glows and has all else of an unlit surface is one: it reflects
// nothing.
fn without_face_normal(words: vec4u) -> vec4u {
    let lower = words.w & 0xffffu;
    let bits = (words.z & 255u) | (((words.z >> 9u) & 63u) << 8u);
    let upper = ((bits & 0xfffu) << 16u) | ((bits >> 12u) << 30u) | OWN_DIELECTRIC;
    let moved = vec4u(words.xy, 0u, lower | upper);
    let unlit = words.x == UNLIT_COLOR && lower == UNLIT_LOWER;
    let kept = vec4u(words.xyz, lower | select(0u, OWN_DIELECTRIC, unlit));
    return select(kept, moved, is_no_glow(words.z));
}
