// Light that passes a surface (KHR_materials_transmission, KHR_materials_volume): what the picture
// shows behind it, at the level of its roughness, where the refracted ray leaves the volume.

#import forward/behind.wgsl
#import forward/film.wgsl
#import forward/lobes.wgsl
#import shared/environment.wgsl
#import shared/frame.wgsl
#import shared/instances.wgsl
#import shared/material.wgsl

@group(3) @binding(0) var picture_behind: texture_2d<f32>;

// Where a world position is seen, in pixels of the target, by the eye that a pixel belongs to.
fn seen_at(position: vec3f, pixel: vec2f) -> vec2f {
    let view = view_at(pixel);
    let clip = frame.views[view].clip_from_world * vec4f(position, 1.0);
    let ndc = clip.xy / max(clip.w, 1e-6);
    return (ndc * vec2f(0.5, -0.5) + 0.5) * frame.size + vec2f(f32(view * frame.eye_stride), 0.0);
}

// The picture behind at a position in pixels of the target, within its eye's picture.
fn behind_at(at: vec2f, pixel: vec2f, roughness: f32) -> vec3f {
    // As blurred as a mirror of that roughness at a distance of about the picture's shorter side.
    let side = min(frame.size.x, frame.size.y);
    let level = min(log2(side) * roughness * clamp(2.0 * lobes.ior - 2.0, 0.0, 1.0), 6.0);
    let picture = picture_of(vec2u(pixel));
    // Half a texel of the coarser level that is read, so that no texel beside the picture is.
    let margin = 0.5 * exp2(ceil(level));
    let inside = clamp(at, vec2f(picture.low) + margin, max(vec2f(picture.end) - margin, vec2f(picture.low) + margin));
    // In the picture behind both are further apart.
    let apart = f32(view_at(pixel)) * (f32(behind_stride()) - f32(frame.eye_stride));
    let uv = (inside + vec2f(apart, 0.0)) / vec2f(textureDimensions(picture_behind));
    return textureSampleLevel(picture_behind, environment_sampler, uv, level).rgb;
}

// Radiance that passes towards the eye; `pixel` in the target.
fn passed_light(s: LobedSurface, pixel: vec2f, i: Instance) -> vec3f {
    let v = direction_to_eye(view_at(pixel), s.base.position);
    let n = s.base.normal;
    let scale = length(vec3f(i.world_x.x, i.world_y.x, i.world_z.x));
    let thickness = s.thickness * scale;
    let refracted = refract(-v, n, 1.0 / lobes.ior);
    let left_at = seen_at(s.base.position + refracted * thickness, pixel);
    let at = select(pixel, left_at, thickness > 0.0);
    let n_dot_v = saturate(dot(n, v));
    // As of what is scattered, what the dielectric reflects of even light is left out.
    var dielectric = s.base;
    if (MATERIAL_CLASS & HAS_IRIDESCENCE) != 0u {
        dielectric = under_film(s.film, s.base, v);
    }
    dielectric.metallic = 0.0;
    let f = environment_reflectance(dielectric, v);
    let left = 1.0 - saturate(max(f.x, max(f.y, f.z)));
    var part = s.transmission * left * (1.0 - s.base.metallic) * below_coat(s, v);
    if (MATERIAL_CLASS & HAS_SHEEN) != 0u {
        part *= below_sheen(s, n_dot_v);
    }
    let kept = exp(-lobes.absorption * thickness);
    return part * s.base.base_color * kept * behind_at(at, pixel, s.base.roughness);
}
