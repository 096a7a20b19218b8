// Radiance to display values.

#import shared/frame.wgsl
#import shared/full_screen.wgsl

// Clipped at 1, else a filmic curve.
override CLIPPED: bool = false;

@group(1) @binding(0) var radiance: texture_2d<f32>;

// Stephen Hill's fit of the ACES reference rendering and output transforms, sRGB to sRGB.
fn aces(color: vec3f) -> vec3f {
    let into = mat3x3f(
        vec3f(0.59719, 0.07600, 0.02840),
        vec3f(0.35458, 0.90834, 0.13383),
        vec3f(0.04823, 0.01566, 0.83777),
    );
    let out = mat3x3f(
        vec3f(1.60475, -0.10208, -0.00327),
        vec3f(-0.53108, 1.10813, -0.07276),
        vec3f(-0.07367, -0.00605, 1.07602),
    );
    let v = into * color;
    let fitted = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081);
    return saturate(out * fitted);
}

fn srgb(linear: vec3f) -> vec3f {
    let low = linear * 12.92;
    let high = 1.055 * pow(max(linear, vec3f(1e-6)), vec3f(1.0 / 2.4)) - 0.055;
    return select(high, low, linear <= vec3f(0.0031308));
}

@fragment
fn tone_map(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let exposed = textureLoad(radiance, vec2u(position.xy), 0).rgb * frame.exposure;
    var mapped = saturate(exposed);
    if !CLIPPED {
        // Far beyond white; keeps the fraction finite.
        mapped = aces(min(exposed, vec3f(1e6)));
    }
    return vec4f(srgb(mapped), 1.0);
}
