// One level of the picture behind from the next finer one: 4 x 4 texels, weighted 1, 3, 3, 1 each
// way, so that it is smooth when it is magnified. Each eye's picture by itself.

#import forward/behind.wgsl
#import shared/frame.wgsl
#import shared/level.wgsl

@group(1) @binding(0) var finer: texture_2d<f32>;

@fragment
fn halve(in: LevelVertex) -> @location(0) vec4f {
    let block = vec2u(in.position.xy);
    let first_column = select(0u, behind_stride(), (block.x << in.level) >= behind_stride());
    let picture = vec2u(first_column, 0u);
    let low = vec2i(picture >> vec2u(in.level - 1u));
    let high = vec2i((picture + vec2u(frame.size) - 1u) >> vec2u(in.level - 1u));
    let first = vec2i(block) * 2 - 1;
    var sum = vec4f(0.0);
    for (var i = 0; i < 16; i++) {
        let step = vec2i(i & 3, i >> 2u);
        let inner = vec2f((step == vec2i(1)) | (step == vec2i(2)));
        let weight = 1.0 + 2.0 * inner;
        let texel = clamp(first + step, low, high);
        sum += weight.x * weight.y * textureLoad(finer, texel, 0);
    }
    return sum / 64.0;
}
