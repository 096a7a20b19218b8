// A point on a surface, ready to be lit, and its packed form in the G-buffer.

#ifdef REDUCED
#import reduced/missing.wgsl
#endif

struct Surface {
    // World space.
    position: vec3f,
    // Unit, world space, turned to the viewer.
    normal: vec3f,
    // The same without what a normal map or lumps bend it by: as vertices have it.
    vertex_normal: vec3f,
    base_color: vec3f,
    metallic: f32,
    // Perceptual.
    roughness: f32,
    // Negative: what the surface mirrors of its environment is in the emissive already.
    occlusion: f32,
    emissive: vec3f,
    // Reflectance of what is not metal: at right angles, and in w at grazing angles.
    dielectric: vec4f,
}

// Of a material that says nothing else: an index of refraction of 1.5.
const PLAIN_DIELECTRIC: vec4f = vec4f(0.04, 0.04, 0.04, 1.0);

// In the last word of a packed surface: the occlusion is negative.
const MIRRORED: u32 = 1u << 28u;
// In the last word of a packed surface: the dielectric is not the plain one.
const OWN_DIELECTRIC: u32 = 1u << 29u;
// In the last word of a packed surface whose dielectric is the plain one: a vertex normal lies below,
// where averages have bits of the base colour.
const OWN_VERTEX_NORMAL: u32 = 1u << 30u;

fn sign_not_zero(v: vec2f) -> vec2f {
    return select(vec2f(-1.0), vec2f(1.0), v >= vec2f(0.0));
}

// Octahedral map (Cigolle et al. 2014, 'A Survey of Efficient Representations for Independent Unit
// Vectors').
fn octahedral_from_unit(n: vec3f) -> vec2f {
    let p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
    return select((1.0 - abs(p.yx)) * sign_not_zero(p), p, n.z >= 0.0);
}

fn unit_from_octahedral(e: vec2f) -> vec3f {
    let z = 1.0 - abs(e.x) - abs(e.y);
    let xy = select((1.0 - abs(e.yx)) * sign_not_zero(e), e, z >= 0.0);
    return normalize(vec3f(xy, z));
}

// Shared-exponent colour: 9 bits a channel, 5 bits of exponent, as in EXT_texture_shared_exponent.
fn pack_shared_exponent(color: vec3f) -> u32 {
    let c = clamp(color, vec3f(0.0), vec3f(65408.0));
    let largest = max(c.x, max(c.y, c.z));
    // Exponent field of the float: floor(log2) without a logarithm.
    let floor_log2 = i32(bitcast<u32>(largest) >> 23u) - 127;
    let below = max(-16, floor_log2) + 16;
    let exponent = below + select(0, 1, u32(largest * exp2_integer(24 - below) + 0.5) == 512u);
    let m = vec3u(c * exp2_integer(24 - exponent) + 0.5);
    return m.x | (m.y << 9u) | (m.z << 18u) | (u32(exponent) << 27u);
}

fn unpack_shared_exponent(word: u32) -> vec3f {
    let m = vec3f(vec3u(word, word >> 9u, word >> 18u) & vec3u(511u));
    return m * exp2_integer(i32(word >> 27u) - 24);
}

// 2^n for -126 <= n <= 127, exactly.
fn exp2_integer(n: i32) -> f32 {
    return bitcast<f32>(u32(n + 127) << 23u);
}

// A dielectric in 22 bits: the square root of the largest channel (8), which channel that is (2),
// the roots of the next two over it (4 each), grazing angles in fourteenths (4).
fn dielectric_bits(d: vec4f) -> u32 {
    let root = sqrt(saturate(d.xyz));
    let largest = max(root.x, max(root.y, root.z));
    let which = select(select(2u, 1u, root.y == largest), 0u, root.x == largest);
    let others = select(select(root.xy, root.zx, which == 1u), root.yz, which == 0u);
    let parts = vec2u(others / max(largest, 1e-6) * 15.0 + 0.5);
    let grazing = u32(saturate(d.w) * 14.0 + 0.5);
    return u32(largest * 255.0 + 0.5) | (which << 8u) | (parts.x << 10u) | (parts.y << 14u) | (grazing << 18u);
}

fn dielectric_from_bits(bits: u32) -> vec4f {
    let largest = f32(bits & 255u) / 255.0;
    let which = (bits >> 8u) & 3u;
    let others = largest * vec2f(vec2u(bits >> 10u, bits >> 14u) & vec2u(15u)) / 15.0;
    let first = vec3f(largest, others);
    let root = select(select(first.yzx, first.zxy, which == 1u), first, which == 0u);
    return vec4f(root * root, min(f32((bits >> 18u) & 15u) / 14.0, 1.0));
}

// A normal in 2 x 12 bits, at the upper end of each half of the word.
fn coarse_normal_bits(n: vec3f) -> u32 {
    let e = vec2i(round(octahedral_from_unit(n) * 2047.0));
    return (u32(e.x << 4u) & 0xffffu) | u32(e.y << 20u);
}

fn normal_from_coarse_bits(word: u32) -> vec2f {
    return vec2f(vec2i(i32(word << 16u) >> 20u, i32(word) >> 20u)) / 2047.0;
}

// Puts a dielectric's bits where only averages have bits of the base colour, and below the normal's
// upper 12 bits.
fn with_dielectric(words: vec4u, n: vec3f, bits: u32) -> vec4u {
    let below = ((bits >> 14u) & 15u) | (((bits >> 18u) & 15u) << 16u);
    let upper = ((bits & 0xfffu) << 16u) | (((bits >> 12u) & 3u) << 30u) | OWN_DIELECTRIC;
    return vec4u(words.x, coarse_normal_bits(n) | below, words.z, words.w | upper);
}

fn dielectric_of(words: vec4u) -> u32 {
    return ((words.w >> 16u) & 0xfffu) | ((words.w >> 30u) << 12u) | ((words.y & 15u) << 14u)
        | (((words.y >> 16u) & 15u) << 18u);
}

// Above this cosine between them the normal is as near to the vertex normal as its bits are.
const HARDLY_BENT: f32 = 0.999;

// A vertex normal in 2 x 6 bits.
fn vertex_normal_bits(n: vec3f) -> vec2u {
    return vec2u(octahedral_from_unit(n) * 31.0 + 31.5);
}

fn vertex_normal_from_bits(bits: vec2u) -> vec3f {
    return unit_from_octahedral(vec2f(bits & vec2u(63u)) / 31.0 - 1.0);
}

// Beside a dielectric a vertex normal lies in the emissive of what does not glow, as what emission
// never gives: the largest exponent with small numbers.
fn glow_of_vertex_normal(bits: vec2u) -> u32 {
    return (31u << 27u) | bits.x | (bits.y << 9u);
}

// Exponent 31, and each channel's highest bit 0.
fn is_no_glow(word: u32) -> bool {
    return (word & 0xfc020100u) == 0xf8000000u;
}

// x: base colour (square roots, 8 bits each) and occlusion; y: normal; z: emissive; w: metallic,
// roughness, and one of these: 4 more bits of each base colour and `MIRRORED`, which only an average
// has; the vertex normal, where the normal is another; the dielectric.
fn pack_surface(s: Surface) -> vec4u {
    let words = vec4u(
        pack4x8unorm(vec4f(sqrt(saturate(s.base_color)), s.occlusion)),
        pack2x16snorm(octahedral_from_unit(s.normal)),
        pack_shared_exponent(s.emissive),
        pack4x8unorm(vec4f(s.metallic, s.roughness, 0.0, 0.0)),
    );
    let is_bent = dot(s.vertex_normal, s.normal) < HARDLY_BENT;
    let bits = vertex_normal_bits(s.vertex_normal);
    let above = OWN_VERTEX_NORMAL | (bits.x << 16u) | (bits.y << 22u);
    var own = with_dielectric(words, s.normal, dielectric_bits(s.dielectric));
    own.z = select(words.z, glow_of_vertex_normal(bits), is_bent & (words.z == 0u));
    // No branch: both may come from uniforms alone.
    let plain = all(s.dielectric == PLAIN_DIELECTRIC) | (s.metallic == 1.0);
    return select(own, vec4u(words.xyz, words.w | select(0u, above, is_bent)), plain);
}

fn unpack_surface(words: vec4u, position: vec3f) -> Surface {
    let own = (words.w & OWN_DIELECTRIC) != 0u;
    let is_above = !own & ((words.w & OWN_VERTEX_NORMAL) != 0u);
    let in_glow = own & is_no_glow(words.z);
    let finer = vec3f((vec3u(words.w) >> vec3u(16u, 20u, 24u)) & vec3u(15u)) / 4080.0;
    let color = unpack4x8unorm(words.x) + vec4f(select(finer, vec3f(0.0), own | is_above), 0.0);
    let material = unpack4x8unorm(words.w);
    let normal = unit_from_octahedral(select(unpack2x16snorm(words.y), normal_from_coarse_bits(words.y), own));
    let bits = select(vec2u(words.w) >> vec2u(16u, 22u), vec2u(words.z) >> vec2u(0u, 9u), in_glow);
    return Surface(
        position,
        normal,
        select(normal, vertex_normal_from_bits(bits), is_above | in_glow),
        color.rgb * color.rgb,
        material.x,
        material.y,
        select(color.a, -color.a, (words.w & MIRRORED) != 0u),
        select(unpack_shared_exponent(words.z), vec3f(0.0), in_glow),
        select(PLAIN_DIELECTRIC, dielectric_from_bits(dielectric_of(words)), own),
    );
}
