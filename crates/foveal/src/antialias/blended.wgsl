// Blended surfaces, drawn at the sub-samples over nothing: averaged band by band, then laid over
// the pixels' radiance. CPU twin: `antialias/blended.rs`.

#import antialias/samples.wgsl
#import shared/full_screen.wgsl

@group(1) @binding(0) var<uniform> band: Band;
// Premultiplied: of sub-samples, or averaged.
@group(1) @binding(1) var blended: texture_2d<f32>;

@fragment
fn average(@builtin(position) position: vec4f) -> @location(0) vec4f {
    var sum = vec4f(0.0);
    for (var i = 0u; i < COUNT; i++) {
        sum += textureLoad(blended, sample_texel(vec2u(position.xy), i), 0);
    }
    return sum / f32(COUNT);
}

@fragment
fn lay_over(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return textureLoad(blended, vec2u(position.xy), 0);
}
