// A point on a surface, ready to be lit, and its packed form in the G-buffer.

#ifdef REDUCED
#import reduced/missing.wgsl
#endif

struct Surface {
    // World space.
    position: vec3f,
    // Unit, world space, turned to the viewer.
    normal: vec3f,
    base_color: vec3f,
    metallic: f32,
    // Perceptual.
    roughness: f32,
    // Negative: what the surface mirrors of its environment is in the emissive already.
    occlusion: f32,
    emissive: vec3f,
}

// In the last word of a packed surface: the occlusion is negative.
const MIRRORED: u32 = 1u << 28u;

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
    var exponent = max(-16, floor_log2) + 16;
    if u32(largest * exp2_integer(24 - exponent) + 0.5) == 512u {
        exponent += 1;
    }
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

// x: base colour (square roots, 8 bits each) and occlusion; y: normal; z: emissive; w: metallic,
// roughness, and 4 more bits of each base colour and `MIRRORED`, which only an average has.
fn pack_surface(s: Surface) -> vec4u {
    return vec4u(
        pack4x8unorm(vec4f(sqrt(saturate(s.base_color)), s.occlusion)),
        pack2x16snorm(octahedral_from_unit(s.normal)),
        pack_shared_exponent(s.emissive),
        pack4x8unorm(vec4f(s.metallic, s.roughness, 0.0, 0.0)),
    );
}

fn unpack_surface(words: vec4u, position: vec3f) -> Surface {
    let finer = vec3f((vec3u(words.w) >> vec3u(16u, 20u, 24u)) & vec3u(15u)) / 4080.0;
    let color = unpack4x8unorm(words.x) + vec4f(finer, 0.0);
    let material = unpack4x8unorm(words.w);
    return Surface(
        position,
        unit_from_octahedral(unpack2x16snorm(words.y)),
        color.rgb * color.rgb,
        material.x,
        material.y,
        select(color.a, -color.a, (words.w & MIRRORED) != 0u),
        unpack_shared_exponent(words.z),
    );
}
