// A material's parameters, and where on a surface its textures are read. Rust:
// `scene/materials.rs`.

#expects material

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
const HAS_SPECULAR: u32 = 512u;
const HAS_SPECULAR_COLOR: u32 = 1024u;
// What is not metal has a reflectance of its own.
const IS_SPECULAR: u32 = 2048u;
// The normal map has x and y alone (BC5).
const NORMAL_OF_TWO: u32 = 65536u;

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
    // Base colour, metallic-roughness, normal, occlusion, emissive, specular, specular colour; the
    // first one's for all where they share it.
    uv: array<UvMap, 7>,
    // Where the textures lie in their arrays, a byte each.
    layers: vec2u,
    // Which of the scene's materials it is.
    number: u32,
    procedural_seed: u32,
    // Cosine and sine of the angle by which the coordinates that tangents follow have turned since
    // the tangents were made; -1 where they have been mirrored, else 1.
    tangent_turn: vec3f,
    // Lumps per metre.
    procedural_frequency: f32,
    // Reflectance at right angles of what is not metal, and at grazing angles: factor of both.
    specular_color: vec3f,
    specular: f32,
    // 0 where the surface has lobes, which are drawn forward; else 1.
    without_lobes: f32,
}

// The unit vector above a plane that has this x and y. Never in the plane: scaled by 0 it still has a
// direction.
fn unit_above(n: vec2f) -> vec3f {
    return vec3f(n, sqrt(max(1.0 - dot(n, n), 1e-6)));
}

// Where all slots share one map it is the first, a constant index: most shaders then look no map up
// by pixel.
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

// A tangent that follows the coordinates' turn; w is the bitangent's sign.
fn turned(normal: vec3f, tangent: vec4f) -> vec4f {
    let bitangent = cross(normal, tangent.xyz) * tangent.w;
    let turn = material.tangent_turn;
    return vec4f(turn.x * tangent.xyz - turn.y * bitangent, turn.z * tangent.w);
}
