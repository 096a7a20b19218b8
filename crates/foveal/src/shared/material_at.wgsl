// The material at a point of a surface.

#import shared/material.wgsl
#import shared/material_textures.wgsl
#import shared/procedural.wgsl
#import shared/surface.wgsl

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
    let vertex_normal = normalize(normal) * facing;
    var n = vertex_normal;
    if (MATERIAL_CLASS & HAS_NORMAL) != 0u {
        var texel = sample_material(normal_texture, normal_sampler, 2u, uv).xyz * 2.0 - 1.0;
        if (MATERIAL_CLASS & NORMAL_OF_TWO) != 0u {
            texel = unit_above(texel.xy);
        }
        if dot(tangent.xyz, tangent.xyz) > 0.0 {
            let t = turned(normal, tangent);
            // As MikkTSpace bakes: interpolated vectors, not normalized before the sum.
            let bitangent = cross(normal, t.xyz) * t.w;
            let scaled = vec3f(texel.xy * material.normal_scale, texel.z);
            n = normalize(scaled.x * t.xyz + scaled.y * bitangent + scaled.z * normal) * facing;
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
    var dielectric = PLAIN_DIELECTRIC;
    if (MATERIAL_CLASS & IS_SPECULAR) != 0u {
        var tint = material.specular_color;
        if (MATERIAL_CLASS & HAS_SPECULAR_COLOR) != 0u {
            tint *= sample_material(specular_color_texture, specular_color_sampler, 6u, uv).rgb;
        }
        var strength = material.specular;
        if (MATERIAL_CLASS & HAS_SPECULAR) != 0u {
            strength *= sample_material(specular_texture, specular_sampler, 5u, uv).a;
        }
        dielectric = vec4f(min(tint, vec3f(1.0)), 1.0) * strength;
    }
    if (MATERIAL_CLASS & IS_UNLIT) != 0u {
        // Black to all light, at all angles: what is left is the colour itself.
        return Shaded(Surface(position, n, n, vec3f(0.0), 0.0, 1.0, 0.0, base.rgb, vec4f(0.0)), base.a);
    }
    metallic = saturate(metallic);
    roughness = saturate(roughness);
    let s = Surface(position, n, vertex_normal, base.rgb, metallic, roughness, occlusion, emissive, dielectric);
    return Shaded(s, base.a);
}
