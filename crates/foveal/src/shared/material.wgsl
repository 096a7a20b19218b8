// The material at a point of a surface. Needs frame, surface and procedural.wgsl, and material_bindings.wgsl
// with sample_implicit.wgsl or what takes their place. Rust: `scene/materials.rs`.

// What the material has, known when the pipeline is made: bits as below.
override MATERIAL_CLASS: u32 = 0u;

const HAS_BASE_COLOR: u32 = 1u;
const HAS_METALLIC_ROUGHNESS: u32 = 2u;
const HAS_NORMAL: u32 = 4u;
const HAS_OCCLUSION: u32 = 8u;
const HAS_EMISSIVE: u32 = 16u;
const IS_UNLIT: u32 = 32u;
const IS_PROCEDURAL: u32 = 64u;
// A texture is read elsewhere than at the first UV set as it is.
const HAS_UV_MAP: u32 = 128u;
// Its textures are read at different places.
const HAS_OWN_UV_MAPS: u32 = 256u;

struct UvMap {
    // u = dot(x.xyz, (u0, v0, 1)); x.w is the UV set.
    x: vec4f,
    y: vec4f,
}

struct Material {
    base_color: vec4f,
    emissive: vec3f,
    metallic: f32,
    roughness: f32,
    normal_scale: f32,
    occlusion_strength: f32,
    // 0 where alpha is no mask.
    alpha_cutoff: f32,
    // Base colour, metallic-roughness, normal, occlusion, emissive; the first one's for all where they share it.
    uv: array<UvMap, 5>,
    // Where the textures lie in their arrays, a byte each.
    layers: vec2u,
    // Which of the scene's materials it is.
    number: u32,
    procedural_seed: u32,
    // Lumps per metre.
    procedural_frequency: f32,
    reserved_0: u32,
    reserved_1: u32,
    reserved_2: u32,
}

// Slots that share one have it in common, which spares shaders that look it up pixel by pixel.
fn uv_map(slot: u32) -> UvMap {
    if (MATERIAL_CLASS & HAS_OWN_UV_MAPS) == 0u {
        return material.uv[0];
    }
    return material.uv[slot];
}

fn uv_of(slot: u32, uv: vec4f) -> vec2f {
    if (MATERIAL_CLASS & HAS_UV_MAP) == 0u {
        return uv.xy;
    }
    let map = uv_map(slot);
    let p = vec3f(select(uv.xy, uv.zw, map.x.w > 0.5), 1.0);
    return vec2f(dot(map.x.xyz, p), dot(map.y.xyz, p));
}

// Opacity alone.
fn alpha_at(uv: vec4f, color_alpha: f32) -> f32 {
    let alpha = material.base_color.a * color_alpha;
    if (MATERIAL_CLASS & HAS_BASE_COLOR) != 0u {
        return alpha * sample_material(base_color_texture, base_color_sampler, 0u, uv).a;
    }
    return alpha;
}

struct Shaded {
    surface: Surface,
    alpha: f32,
}

// `bitangent_sign` is glTF's tangent.w; `front` tells which side is seen.
fn material_at(position: vec3f, normal: vec3f, tangent: vec4f, uv: vec4f, color: vec4f, front: bool) -> Shaded {
    var base = material.base_color * color;
    if (MATERIAL_CLASS & HAS_BASE_COLOR) != 0u {
        base *= sample_material(base_color_texture, base_color_sampler, 0u, uv);
    }
    var metallic = material.metallic;
    var roughness = material.roughness;
    if (MATERIAL_CLASS & HAS_METALLIC_ROUGHNESS) != 0u {
        let texel = sample_material(metallic_roughness_texture, metallic_roughness_sampler, 1u, uv);
        roughness *= texel.g;
        metallic *= texel.b;
    }
    let facing = select(-1.0, 1.0, front);
    var n = normalize(normal) * facing;
    if (MATERIAL_CLASS & HAS_NORMAL) != 0u {
        let texel = sample_material(normal_texture, normal_sampler, 2u, uv).xyz * 2.0 - 1.0;
        if dot(tangent.xyz, tangent.xyz) > 0.0 {
            // As MikkTSpace bakes: interpolated vectors, not normalized before the sum.
            let bitangent = cross(normal, tangent.xyz) * tangent.w;
            let scaled = vec3f(texel.xy * material.normal_scale, texel.z);
            n = normalize(scaled.x * tangent.xyz + scaled.y * bitangent + scaled.z * normal) * facing;
        }
    }
    if (MATERIAL_CLASS & IS_PROCEDURAL) != 0u {
        let layers = procedural_at(position, material.procedural_seed, material.procedural_frequency, pixel_size(position));
        base = vec4f(base.rgb * layers.tint, base.a);
        roughness = layers.roughness;
        n = procedural_normal(n, layers.slope);
    }
    var occlusion = 1.0;
    if (MATERIAL_CLASS & HAS_OCCLUSION) != 0u {
        let texel = sample_material(occlusion_texture, occlusion_sampler, 3u, uv);
        occlusion = 1.0 + material.occlusion_strength * (texel.r - 1.0);
    }
    var emissive = material.emissive;
    if (MATERIAL_CLASS & HAS_EMISSIVE) != 0u {
        emissive *= sample_material(emissive_texture, emissive_sampler, 4u, uv).rgb;
    }
    if (MATERIAL_CLASS & IS_UNLIT) != 0u {
        // Black to all light: what is left is the colour itself.
        return Shaded(Surface(position, n, vec3f(0.0), 0.0, 1.0, 0.0, base.rgb), base.a);
    }
    return Shaded(Surface(position, n, base.rgb, saturate(metallic), saturate(roughness), occlusion, emissive), base.a);
}
