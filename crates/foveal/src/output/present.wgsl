// The picture into the host's texture, stretched to its size.

// Whether the target encodes sRGB by itself.
override ENCODED_BY_TARGET: bool = false;
// Pictures side by side, one or two, which are stretched each by itself.
override PICTURES: u32 = 1u;

@group(1) @binding(0) var picture: texture_2d<f32>;
@group(1) @binding(1) var bilinear: sampler;

struct PresentVertex {
    @builtin(position) position: vec4f,
    @location(0) place: vec2f,
}

@vertex
fn full_screen(@builtin(vertex_index) index: u32) -> PresentVertex {
    let corner = vec2f(f32(index & 1u) * 2.0, f32(index >> 1u) * 2.0);
    return PresentVertex(vec4f(corner * 2.0 - 1.0, 0.0, 1.0), vec2f(corner.x, 1.0 - corner.y));
}

// Where a pixel of the target looks into the picture, by its width.
fn looked_up(pixel: f32, place: f32) -> f32 {
    let across = f32(textureDimensions(picture).x);
    // The target's, exact in its right half, where alone it counts.
    let target_across = round(pixel / place);
    // Pictures are cut at whole pixels. Of an odd width the left one has one more: `eyes.wgsl`.
    let cut = ceil(0.5 * across) / across;
    let target_cut = ceil(0.5 * target_across);
    let border = 0.5 / across;
    if PICTURES == 1u {
        return clamp(place, border, 1.0 - border);
    }
    if pixel < target_cut {
        return clamp(place, border, cut - border);
    }
    return clamp(place + (cut - target_cut / target_across), cut + border, 1.0 - border);
}

@fragment
fn present(in: PresentVertex) -> @location(0) vec4f {
    let x = looked_up(in.position.x, in.place.x);
    let encoded = textureSampleLevel(picture, bilinear, vec2f(x, in.place.y), 0.0).rgb;
    if !ENCODED_BY_TARGET {
        return vec4f(encoded, 1.0);
    }
    let low = encoded / 12.92;
    let high = pow((encoded + 0.055) / 1.055, vec3f(2.4));
    return vec4f(select(high, low, encoded <= vec3f(0.04045)), 1.0);
}
