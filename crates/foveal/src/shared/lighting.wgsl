// How a surface is lit: the one lighting model of all passes. Needs frame, surface, light and light_list.wgsl.

// Blinn-Phong as in the techniques' sources, else metallic-roughness GGX.
override BLINN_PHONG: bool = false;
// Every light at every sample, else those of the sample's cluster.
override BRUTE: bool = false;

const PI: f32 = 3.14159265;

// Light arriving at a position: unit direction to the light, and irradiance on a facing surface.
struct Arriving {
    direction: vec3f,
    irradiance: vec3f,
}

fn arriving(light: Light, position: vec3f) -> Arriving {
    if light.kind == LIGHT_DIRECTIONAL {
        return Arriving(-light.direction, light.radiant);
    }
    let to_light = light.position - position;
    let squared = max(dot(to_light, to_light), 1e-4);
    let direction = to_light * inverseSqrt(squared);
    // KHR_lights_punctual's recommended window: 1 - (d/range)^4.
    let ratio = squared / (light.range * light.range);
    var attenuation = saturate(1.0 - ratio * ratio) / squared;
    if light.kind == LIGHT_SPOT {
        let cone = saturate(-dot(light.direction, direction) * light.spot_scale + light.spot_offset);
        attenuation *= cone * cone;
    }
    return Arriving(direction, light.radiant * attenuation);
}

// Lambert and GGX: glTF 2.0 appendix B, with the height-correlated visibility term (Heitz 2014).
fn reflect_ggx(s: Surface, v: vec3f, l: vec3f, n_dot_l: f32) -> vec3f {
    let h = normalize(v + l);
    let n_dot_v = max(dot(s.normal, v), 1e-4);
    let n_dot_h = saturate(dot(s.normal, h));
    let v_dot_h = saturate(dot(v, h));
    let alpha = max(s.roughness * s.roughness, 0.002);
    let a2 = alpha * alpha;
    let d = n_dot_h * n_dot_h * (a2 - 1.0) + 1.0;
    let distribution = a2 / (PI * d * d);
    let visibility = 0.5 / (n_dot_l * sqrt(n_dot_v * n_dot_v * (1.0 - a2) + a2)
        + n_dot_v * sqrt(n_dot_l * n_dot_l * (1.0 - a2) + a2));
    let f0 = mix(vec3f(0.04), s.base_color, s.metallic);
    let m = 1.0 - v_dot_h;
    let m2 = m * m;
    let fresnel = f0 + (1.0 - f0) * (m2 * m2 * m);
    let diffuse = (1.0 - fresnel) * (1.0 - s.metallic) * s.base_color / PI;
    return diffuse + fresnel * (distribution * visibility);
}

// Lambert and normalized Blinn-Phong, the exponent taken from the roughness.
fn reflect_blinn_phong(s: Surface, v: vec3f, l: vec3f) -> vec3f {
    let h = normalize(v + l);
    let alpha = max(s.roughness * s.roughness, 0.03);
    let exponent = 2.0 / (alpha * alpha) - 2.0;
    let f0 = mix(vec3f(0.04), s.base_color, s.metallic);
    let highlight = (exponent + 8.0) / (8.0 * PI) * pow(max(dot(s.normal, h), 1e-6), exponent);
    return s.base_color * (1.0 - s.metallic) / PI + f0 * highlight;
}

fn reflect_light(s: Surface, v: vec3f, light: Light) -> vec3f {
    let a = arriving(light, s.position);
    let n_dot_l = dot(s.normal, a.direction);
    if n_dot_l <= 0.0 || all(a.irradiance <= vec3f(0.0)) {
        return vec3f(0.0);
    }
    if BLINN_PHONG {
        return reflect_blinn_phong(s, v, a.direction) * a.irradiance * n_dot_l;
    }
    return reflect_ggx(s, v, a.direction, n_dot_l) * a.irradiance * n_dot_l;
}

// The surroundings' light in a rough mirror (environment BRDF after Karis 2014, 'Physically Based Shading on Mobile').
fn mirrored(s: Surface, v: vec3f) -> vec3f {
    let n_dot_v = saturate(dot(s.normal, v));
    let f0 = mix(vec3f(0.04), s.base_color, s.metallic);
    let r = s.roughness * vec4f(-1.0, -0.0275, -0.572, 0.022) + vec4f(1.0, 0.0425, 1.04, -0.04);
    let a004 = min(r.x * r.x, exp2(-9.28 * n_dot_v)) * r.x + r.y;
    let scale_bias = vec2f(-1.04, 1.04) * a004 + r.zw;
    let mirror = mix(reflect(-v, s.normal), s.normal, s.roughness * s.roughness);
    return (f0 * scale_bias.x + scale_bias.y) * environment(normalize(mirror));
}

// The surroundings' light: a cosine-weighted look along the normal, and the mirror.
fn ambient(s: Surface, v: vec3f) -> vec3f {
    let irradiance = mix(mix(frame.nadir, frame.zenith, 0.5 + 0.5 * s.normal.y), frame.horizon, 0.4);
    let diffuse = s.base_color * (1.0 - s.metallic) * irradiance;
    return (diffuse + select(mirrored(s, v), vec3f(0.0), s.occlusion < 0.0)) * abs(s.occlusion);
}

// Index of the first light word of the cluster at a position in pixels of the target and a distance along the view
// axis.
fn cluster_words_at(pixel: vec2f, distance: f32) -> u32 {
    let view = view_at(pixel);
    let moved = in_eye(pixel) + vec2f(frame.views[view].cluster_shift_x, frame.views[view].cluster_shift_y);
    let tile = min(vec2u(moved / frame.cluster_tile), frame.cluster_counts.xy - 1u);
    let cluster = tile.x + frame.cluster_counts.x * (tile.y + frame.cluster_counts.y * cluster_slice(distance));
    return cluster * light_words();
}

// Radiance that leaves a surface towards the eye. Lights are summed in ascending order whichever way they
// are found, so that clustered and brute agree to the bit.
fn lit(s: Surface, pixel: vec2f, distance: f32) -> vec3f {
    let v = direction_to_eye(view_at(pixel), s.position);
    var sum = s.emissive + ambient(s, v);
    let first = cluster_words_at(pixel, distance);
    for (var word = 0u; word < light_words(); word++) {
        let valid = min(light_count() - word * 32u, 32u);
        var bits = select((1u << valid) - 1u, 0xffffffffu, valid == 32u);
        if !BRUTE {
            bits = cluster_word(first + word);
        }
        while bits != 0u {
            let bit = firstTrailingBit(bits);
            bits &= bits - 1u;
            sum += reflect_light(s, v, light_at(word * 32u + bit));
        }
    }
    return sum;
}
