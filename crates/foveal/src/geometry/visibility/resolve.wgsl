// From triangles to the G-buffer's surfaces: the pixels of one family of materials, or of one
// material.

#variant BY_FAMILY EVERY
#variant BY_FAMILY RATED
#variant BY_FAMILY TILED
#variant BY_FAMILY FURTHER
#variant BY_MATERIAL EVERY
#variant BY_MATERIAL RATED
#variant BY_MATERIAL TILED
#variant BY_MATERIAL FURTHER
#import geometry/visibility/family.wgsl
#import shared/attributes.wgsl
#import shared/below_lobes.wgsl
#import shared/face_normal.wgsl
#import shared/frame.wgsl
#import shared/layers.wgsl
#import shared/material_at.wgsl
#import shared/sample_gradients.wgsl
#import shared/surface.wgsl
#import shared/vertex.wgsl
#import geometry/visibility/listed.wgsl
#ifdef BY_FAMILY
#import geometry/visibility/by_family.wgsl
#else
#import geometry/visibility/by_material.wgsl
#endif

// As in geometry/gbuffer.wgsl.
override FACE_NORMAL: bool = false;
// Side of what textures are filtered over, in pixels.
override FOOTPRINT: f32 = 1.0;
// Windows in use, 1 to 8.
override WINDOWS: u32 = 1u;

// Parts of the target, and where the frame (both eyes) lies relative to it: left, top, width,
// height in texels.
struct Windows {
    frames: array<vec4f, 8>,
    parts: array<vec4u, 8>,
}

@group(3) @binding(0) var identity: texture_2d_array<u32>;
@group(3) @binding(1) var triangles: texture_2d_array<u32>;
@group(3) @binding(2) var<storage, read> families: array<Family>;
@group(3) @binding(3) var<storage, read> pixels: array<u32>;
@group(3) @binding(4) var<uniform> windows: Windows;
@group(3) @binding(5) var surface: texture_storage_2d_array<rgba32uint, write>;
#ifdef RATED
// Shading rates or owner levels of 2 x 2 pixels each.
@group(3) @binding(6) var mask: texture_2d<u32>;
#endif
#ifdef TILED
// Shading rates or owner levels of 2 x 2 pixels each.
@group(3) @binding(6) var mask: texture_2d<u32>;
#endif

// The frame around a texel.
fn frame_around(texel: vec2u) -> vec4f {
    var found = windows.frames[0];
    for (var i = 1u; i < WINDOWS; i++) {
        let part = windows.parts[i];
        let inside = all(texel >= part.xy) && all(texel < part.xy + part.zw);
        found = select(found, windows.frames[i], inside);
    }
    return found;
}

@compute @workgroup_size(64)
fn resolve(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let family = families[dispatch_number()];
    let index = (group.y * family.groups_x + group.x) * 64u + local;
    if index >= family.count {
        return;
    }
    let packed = pixels[family.first + index];
    let texel = vec2u(packed & 0xffffu, packed >> 16u);
    let extent = extent_of(texel);
    let around = frame_around(texel);
    // Texels per pixel: sub-samples have their own.
    let scale = around.zw / frame.target_size;
    let pixel = (center_of(texel) - around.xy) / scale;
    let ndc = ndc_of(in_eye(pixel));
    let step = vec2f(2.0, -2.0) / (frame.size * scale) * vec2f(extent) * FOOTPRINT;
    let instance = load_words(identity, texel).x - 1u;
    let triangle = load_words(triangles, texel).x;
    let a = attributes_at(frame.views[view_at(pixel)].clip_from_world, instance, triangle, ndc, step);
    take_material_of(instance);
    uv_right = a.uv_right;
    uv_down = a.uv_down;
    let m = material_at(a.position, a.normal, a.tangent, a.uv, a.color, a.front);
    var words = pack_surface(below_lobes(m.surface, material.without_lobes));
    if FACE_NORMAL {
        words = with_face_normal(words, unit_or(a.face, m.surface.normal));
    }
    let end = min(texel + covered_by(texel), whole_size(identity));
    for (var y = texel.y; y < end.y; y++) {
        for (var x = texel.x; x < end.x; x++) {
            let at = in_layers(textureDimensions(surface).x, vec2u(x, y));
            textureStore(surface, at.xy, at.z, words);
        }
    }
}
