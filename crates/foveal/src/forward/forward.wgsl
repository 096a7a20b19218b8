// Forward pass: points and lines, surfaces with lobes, at the depth where the G-buffer has them, what
// is blended, back to front over the deferred picture, and surfaces that light passes.

#variant
#variant CLIPPED
#variant LAYERED
#variant REDUCED
#variant STROKES
#variant STROKES CLIPPED
#variant STROKES LAYERED
#variant STROKES REDUCED
#variant LOBES
#variant LOBES CLIPPED
#variant LOBES LAYERED
#variant LOBES REDUCED
#variant LOBES TRANSMISSION
#variant LOBES TRANSMISSION CLIPPED
#variant LOBES TRANSMISSION LAYERED
#variant LOBES TRANSMISSION REDUCED
#import shared/frame.wgsl
#import shared/lighting.wgsl
#import shared/material_at.wgsl
#import shared/vertex.wgsl
#ifndef REDUCED
#import shared/light.wgsl
#endif
#ifdef LOBES
#import forward/lobes.wgsl
#endif
#ifdef TRANSMISSION
#import forward/transmission.wgsl
#import shared/instances.wgsl
#import shared/material_bindings.wgsl
#endif
#ifdef STROKES
#import shared/material_bindings.wgsl
#endif

// Each eye is drawn to a layer of its own.
override LAYERED: bool = false;
// Drawn at sub-samples: what is drawn to has other texels than the picture.
override SAMPLED: bool = false;

#ifdef TRANSMISSION
// Alpha cuts holes.
override MASKED: bool = false;
#endif
#ifdef STROKES
// Alpha cuts holes.
override MASKED: bool = false;
// Alpha is ignored.
override OPAQUE: bool = false;
// Some have normals.
override LIT: bool = false;
#endif
#ifdef LOBES
// Alpha is ignored.
override OPAQUE: bool = false;
// Added to pixels in which the surface is black.
override ADDED: bool = false;
#endif

#ifdef TABLES
@group(2) @binding(0) var light_table: texture_2d<u32>;
#else
@group(2) @binding(0) var<storage, read> lights: Lights;
#endif
#ifdef REDUCED
@group(2) @binding(1) var cluster_table: texture_2d<u32>;
#else
@group(2) @binding(1) var<storage, read> cluster_lights: array<u32>;
#endif
#ifdef TABLES
@group(2) @binding(2) var shadow_table: texture_2d<u32>;
#else
@group(2) @binding(2) var<storage, read> shadow_rows: array<vec4u>;
#endif
@group(2) @binding(3) var shadow_atlas: texture_depth_2d;
@group(2) @binding(4) var shadow_sampler: sampler_comparison;

// A fragment's position in pixels of the target.
fn target_position(in: VertexOut) -> vec2f {
    let right = (in.instance & RIGHT_EYE) != 0u;
    if SAMPLED {
        let in_picture = (in.now.xy / in.now.z * vec2f(0.5, -0.5) + 0.5) * frame.size;
        return in_picture + vec2f(select(0.0, f32(frame.eye_stride), right), 0.0);
    }
    let beside = LAYERED && right;
    return in.clip.xy + vec2f(select(0.0, f32(frame.eye_stride), beside), 0.0);
}

@fragment
fn fragment(in: VertexOut, @builtin(front_facing) front: bool) -> @location(0) vec4f {
#ifdef STROKES
    // A quad that faces the eye: its winding says nothing.
    let m = material_at(in.world, in.normal, in.tangent, in.uv, in.color, true);
#else
    let m = material_at(in.world, in.normal, in.tangent, in.uv, in.color, front);
#endif
#ifdef LOBES
    let lobed = lobes_at(m.surface, in.normal, in.tangent, in.uv, select(-1.0, 1.0, front));
#endif
    if is_beyond(in.now, in.instance) {
        discard;
    }
#ifdef STROKES
    if MASKED && m.alpha < material.alpha_cutoff {
        discard;
    }
#endif
#ifdef TRANSMISSION
    if MASKED && m.alpha < material.alpha_cutoff {
        discard;
    }
#endif
    let pixel = target_position(in);
    let view = frame.views[view_at(pixel)];
    let distance = dot(in.world - view.world_from_view[3].xyz, view.forward);
#ifdef LOBES
#ifdef TRANSMISSION
    let passed = passed_light(lobed, pixel, instance_at(in.instance & ~RIGHT_EYE));
    let radiance = min(lit_with_lobes(lobed, pixel, distance) + passed, vec3f(65504.0));
#else
    let radiance = min(lit_with_lobes(lobed, pixel, distance), vec3f(65504.0));
#endif
    let alpha = select(saturate(m.alpha), 1.0, OPAQUE);
    if ADDED {
        return vec4f(radiance, 0.0);
    }
#else
#ifdef STROKES
    // glTF 2.0, section 3.9.7: without normals, the sum of base colour and emission.
    var light = m.surface.base_color + m.surface.emissive;
    if LIT {
        light = select(light, radiance_of(m.surface, pixel, distance, false), any(in.normal != vec3f(0.0)));
    }
    let radiance = min(light, vec3f(65504.0));
    let alpha = select(saturate(m.alpha), 1.0, OPAQUE);
#else
    let radiance = radiance_of(m.surface, pixel, distance, false);
    let alpha = saturate(m.alpha);
#endif
#endif
    // Premultiplied.
    return vec4f(radiance * alpha, alpha);
}
