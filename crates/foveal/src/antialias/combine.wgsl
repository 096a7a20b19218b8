// Combination: the ordinary path's radiance with what was shaded besides. After frame.wgsl and weight.wgsl.

// The sums hold all of an edge pixel; else the largest surface is the ordinary path's.
override ALL: bool = false;
// Sub-samples per pixel.
override COUNT: u32 = 4u;

@group(1) @binding(0) var ordinary: texture_2d<f32>;
@group(1) @binding(1) var sums: texture_2d<f32>;
@group(1) @binding(2) var tally: texture_2d<u32>;

@vertex
fn full_screen(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn combine(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let times = textureLoad(tally, pixel, 0).xy;
    if times.x <= 1u {
        return textureLoad(ordinary, pixel, 0);
    }
    var sum = textureLoad(sums, pixel, 0);
    if !ALL {
        let radiance = textureLoad(ordinary, pixel, 0).rgb;
        sum += vec4f(radiance, 1.0) * (weight_of(radiance) * f32(times.y) / f32(COUNT));
    }
    return vec4f(sum.rgb / sum.a, 1.0);
}
