// Sub-samples whose surfaces are stored: what each knows, and what several see together.

#import antialias/samples.wgsl
#import antialias/surfaces.wgsl
#import shading/input.wgsl
#import shared/face_normal.wgsl
#import shared/frame.wgsl
#import shared/layers.wgsl
#import shared/surface.wgsl
#import shared/environment.wgsl

@group(2) @binding(0) var<uniform> band: Band;
@group(2) @binding(1) var sample_identity: texture_2d<u32>;

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
        return Facet(0u, index, vec3f(0.0), vec3f(0.0));
    }
    let distance = view_distance(load_depth(gbuffer_depth, texel));
    let position = view_position(sample_position(pixel, index), distance);
    return Facet(instance, index, position, face_normal(load_words(gbuffer_surface, texel).w));
}

// The environment's specular radiance is averaged too, not found for the average: it changes too
// fast with the normal.
override MIRROR: bool = false;

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
    var sum = Surface(vec3f(0.0), vec3f(0.0), vec3f(0.0), vec3f(0.0), 0.0, 0.0, 0.0, vec3f(0.0), PLAIN_DIELECTRIC);
    var depth = 0.0;
    var position = vec2f(0.0);
    let part = 1.0 / f32(countOneBits(members));
    for (var left = members; left != 0u; left &= left - 1u) {
        let index = firstTrailingBit(left);
        let texel = sample_texel(pixel, index);
        let with_face = load_words(gbuffer_surface, texel);
        let words = without_face_normal(with_face);
        let sample_depth = load_depth(gbuffer_depth, texel);
        let at = sample_position(pixel, index);
        let s = unpack_surface(words, world_position(at, view_distance(sample_depth)));
        sum.normal += s.normal;
        // Turned to the viewer, as normals are.
        sum.vertex_normal -= normalize(face_normal(with_face.w));
        sum.base_color += s.base_color;
        sum.metallic += s.metallic;
        sum.roughness += s.roughness;
        sum.occlusion += s.occlusion;
        sum.emissive += s.emissive;
        // As differences, so that plain ones stay so to the bit.
        sum.dielectric += (s.dielectric - PLAIN_DIELECTRIC) * part;
        if MIRROR {
            let v = direction_to_eye(view_at(at), s.position);
            let seen = mirrored_seen(s, v, environment_seen(at, view_distance(sample_depth)));
            sum.emissive += s.occlusion * environment_specular(s, v, environment_look(s, v, false)) * seen;
        }
        depth += sample_depth;
        position += at;
    }
    // Opposite normals may cancel: then any is as good.
    let normal = normalize(sum.normal + vec3f(0.0, 1e-6, 0.0));
    let mean = Surface(
        vec3f(0.0),
        normal,
        normalize(sum.vertex_normal + 1e-6 * normal),
        sum.base_color * part,
        sum.metallic * part,
        sum.roughness * part,
        sum.occlusion * part,
        sum.emissive * part,
        sum.dielectric,
    );
    var words = pack_surface(mean);
    words.w |= select(0u, MIRRORED, MIRROR);
    if (words.w & (OWN_DIELECTRIC | OWN_VERTEX_NORMAL)) != 0u {
        return Blend(words, depth * part, position * part);
    }
    let color = vec3u(round(sqrt(saturate(mean.base_color)) * 4080.0));
    words.x = (words.x & 0xff000000u) | (color.r >> 4u) | ((color.g >> 4u) << 8u) | ((color.b >> 4u) << 16u);
    words.w |= ((color.r & 15u) << 16u) | ((color.g & 15u) << 20u) | ((color.b & 15u) << 24u);
    return Blend(words, depth * part, position * part);
}
