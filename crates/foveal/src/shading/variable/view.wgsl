// The rates over the finished frame.

#import shading/variable/rates.wgsl
#import shared/full_screen.wgsl

// 1 rates in the original method's colours, 2 quads of which nothing was known, 3 the samples' own
// pixels.
override VIEW: u32 = 1u;

@group(1) @binding(0) var finished: texture_2d<f32>;
@group(1) @binding(1) var mask: texture_2d<u32>;

// Monsho's: black 1x1, red 1x2, green 2x1, blue 2x2; white 4x4.
fn color_of(rate: u32) -> vec3f {
    let quad = vec3f(f32(rate == RATE_TALL), f32(rate == RATE_WIDE), f32(rate == 3u));
    return select(quad, vec3f(1.0), (rate & RATE_BLOCK) != 0u);
}

@fragment
fn show(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2u(position.xy);
    let color = textureLoad(finished, texel, 0).rgb;
    let cell = textureLoad(mask, texel / 2u, 0).x;
    if VIEW == 1u {
        return vec4f(mix(color, color_of(cell & RATE), 0.6), 1.0);
    }
    if VIEW == 2u {
        let unknown = (cell & RATE_UNKNOWN) != 0u;
        let probed = (cell & RATE_PROBED) != 0u;
        return vec4f(mix(color, vec3f(f32(unknown), f32(probed), 0.0), select(0.0, 0.7, unknown || probed)), 1.0);
    }
    return vec4f(color * select(0.1, 1.0, stands_for_sample(texel, cell & RATE)), 1.0);
}
