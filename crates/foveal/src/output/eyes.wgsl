// What the picture shows of the eyes' pictures, which hold sRGB values. CPU twin:
// `stereo/tests/present.rs`.

#import shared/frame.wgsl
#import shared/full_screen.wgsl

// 0 the left eye, 1 both side by side, 2 at half the width each, 3 anaglyph, 4 anaglyph after
// Dubois, 5 headset.
override OUTPUT: u32 = 0u;
// The headset's picture fades to black within this part of its height at the eyes' borders.
const FADE: f32 = 0.02;

struct Shown {
    // Left, right, bottom, top of each eye's half of the screen, as tangents without the lens.
    screen: array<vec4f, 2>,
    // k1, k2, k3, unused.
    distortion: vec4f,
    // c0 and c1 of red, then of blue.
    fringe: vec4f,
}

@group(1) @binding(0) var pictures: texture_2d<f32>;
@group(1) @binding(1) var<uniform> lens: Shown;

// A pixel of an eye's picture.
fn seen_by(view: u32, pixel: vec2u) -> vec3f {
    // Both eyes show the same picture where there is one alone.
    let beside = vec2u(frame.target_size - frame.size);
    return textureLoad(pictures, pixel + view * beside, 0).rgb;
}

fn linear(srgb: vec3f) -> vec3f {
    let high = pow((max(srgb, vec3f(0.04)) + 0.055) / 1.055, vec3f(2.4));
    return select(high, srgb / 12.92, srgb <= vec3f(0.04045));
}

fn encoded(linear: vec3f) -> vec3f {
    let high = 1.055 * pow(max(linear, vec3f(1e-6)), vec3f(1.0 / 2.4)) - 0.055;
    return select(high, linear * 12.92, linear <= vec3f(0.0031308));
}

fn half_width(pixel: vec2u) -> vec3f {
    let size = vec2u(frame.size);
    let half = (size.x + 1u) / 2u;
    let view = u32(pixel.x >= half);
    let first = vec2u((pixel.x - view * half) * 2u, pixel.y);
    let second = min(first + vec2u(1u, 0u), size - 1u);
    return encoded(0.5 * (linear(seen_by(view, first)) + linear(seen_by(view, second))));
}

// Rec. 601 luma of the left eye in red, of the right one in green and blue, as the technique's
// source has it.
fn anaglyph(pixel: vec2u) -> vec3f {
    let weights = vec3f(0.299, 0.587, 0.114);
    let left = dot(seen_by(0u, pixel), weights);
    let right = dot(seen_by(1u, pixel), weights);
    return vec3f(left, right, right);
}

// Dubois 2001, 'A projection method to generate anaglyph stereo images' (ICASSP), the least-squares
// matrices for red-cyan glasses on a display with sRGB's primaries; they act on linear light.
fn dubois(pixel: vec2u) -> vec3f {
    let from_left = mat3x3f(
        vec3f(0.4561, -0.0400822, -0.0152161),
        vec3f(0.500484, -0.0378246, -0.0205971),
        vec3f(0.176381, -0.0157589, -0.00546856),
    );
    let from_right = mat3x3f(
        vec3f(-0.0434706, 0.378476, -0.0721527),
        vec3f(-0.0879388, 0.73364, -0.112961),
        vec3f(-0.00155529, -0.0184503, 1.2264),
    );
    let sum = from_left * linear(seen_by(0u, pixel)) + from_right * linear(seen_by(1u, pixel));
    return encoded(saturate(sum));
}

// Linear light at a position in pixels of an eye's picture, bilinear; fades to black at its
// borders.
fn light_at(view: u32, position: vec2f) -> vec3f {
    let size = vec2i(frame.size);
    let corner = clamp(position, vec2f(-1.0), frame.size + 1.0) - 0.5;
    let first = vec2i(floor(corner));
    let part = corner - floor(corner);
    var sum = vec3f(0.0);
    for (var i = 0u; i < 4u; i++) {
        let step = vec2u(i, i >> 1u) & vec2u(1u);
        let weight = select(1.0 - part, part, step == vec2u(1u));
        let texel = vec2u(clamp(first + vec2i(step), vec2i(0), size - 1));
        sum += weight.x * weight.y * linear(seen_by(view, texel));
    }
    let inside = min(position, frame.size - position);
    return sum * saturate(min(inside.x, inside.y) / (FADE * frame.size.y));
}

// Where an eye's picture shows a direction, given by its tangents.
fn pixel_of(view: u32, tangent: vec2f) -> vec2f {
    let to_view = frame.views[view].view_from_ndc;
    let ndc = (tangent - to_view.zw) / to_view.xy;
    return (ndc * vec2f(0.5, -0.5) + 0.5) * frame.size;
}

fn headset(pixel: vec2u) -> vec3f {
    let view = u32(pixel.x >= u32(frame.size.x));
    let at = (vec2f(pixel) - vec2f(f32(view) * frame.size.x, 0.0) + 0.5) / frame.size;
    let screen = lens.screen[view];
    let p = mix(vec2f(screen.x, screen.w), vec2f(screen.y, screen.z), at);
    let u = dot(p, p);
    let k = lens.distortion;
    let green = p * (1.0 + u * (k.x + u * (k.y + u * k.z)));
    let red = green * (lens.fringe.x + lens.fringe.y * u);
    let blue = green * (lens.fringe.z + lens.fringe.w * u);
    return encoded(vec3f(
        light_at(view, pixel_of(view, red)).r,
        light_at(view, pixel_of(view, green)).g,
        light_at(view, pixel_of(view, blue)).b,
    ));
}

@fragment
fn show_eyes(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    switch OUTPUT {
        case 0u: { return vec4f(seen_by(0u, pixel), 1.0); }
        case 1u: {
            let view = u32(pixel.x >= u32(frame.size.x));
            return vec4f(seen_by(view, pixel - vec2u(view * u32(frame.size.x), 0u)), 1.0);
        }
        case 2u: { return vec4f(half_width(pixel), 1.0); }
        case 3u: { return vec4f(anaglyph(pixel), 1.0); }
        case 4u: { return vec4f(dubois(pixel), 1.0); }
        default: { return vec4f(headset(pixel), 1.0); }
    }
}
