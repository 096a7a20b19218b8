// Views of anti-aliasing: where pixels are shaded more than once, and how often.

#import shared/full_screen.wgsl

// 0 edges, 1 how often.
override VIEW: u32 = 0u;
override COUNT: u32 = 4u;

@group(1) @binding(0) var tally: texture_2d<u32>;

@fragment
fn view(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let shades = textureLoad(tally, vec2u(position.xy), 0).x;
    if VIEW == 0u {
        return vec4f(vec3f(select(0.0, 1.0, shades > 1u)), 1.0);
    }
    // Black, blue, red, yellow, white.
    let part = 4.0 * f32(shades - 1u) / f32(max(COUNT, 2u) - 1u);
    return vec4f(saturate(part - 1.0), saturate(part - 2.0), saturate(min(part, 2.0 - part) + max(part - 3.0, 0.0)), 1.0);
}
