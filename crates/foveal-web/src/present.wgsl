// The left picture, a line, the right picture.

@group(0) @binding(0) var left: texture_2d<f32>;
@group(0) @binding(1) var right: texture_2d<f32>;
// x: the line's place in pixels.
@group(0) @binding(2) var<uniform> split: vec4f;

@vertex
fn cover(@builtin(vertex_index) corner: u32) -> @builtin(position) vec4f {
    let at = vec2f(f32((corner << 1u) & 2u), f32(corner & 2u));
    return vec4f(at * 2.0 - 1.0, 0.0, 1.0);
}

@fragment
fn present(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let texel = vec2u(at.xy);
    let picture = select(textureLoad(right, texel, 0), textureLoad(left, texel, 0), at.x < split.x);
    let line = abs(at.x - split.x) < 1.0 && split.x >= 1.0 && split.x <= f32(textureDimensions(right).x) - 1.0;
    return vec4f(select(picture.rgb, vec3f(1.0), line), 1.0);
}
