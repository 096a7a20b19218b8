// What is known of each quad, carried over from the frame before. After frame, rates and passes.wgsl.
// CPU twin: `twin.rs`.
//
// Known are the luminances of the quad's four pixels when they were last shaded one by one: a quad that was shaded
// coarsely keeps those from before. So no rate ever depends on what coarse shading made of the picture.

@group(1) @binding(0) var<uniform> rates: Rates;
@group(1) @binding(1) var identity: texture_2d_array<u32>;
@group(1) @binding(2) var depth: texture_depth_2d_array;
// Of the frame before: what was known, at which rate it was shaded, its picture.
@group(1) @binding(3) var before: texture_2d<u32>;
@group(1) @binding(4) var mask_before: texture_2d<u32>;
@group(1) @binding(5) var picture_before: texture_2d<f32>;
// Luminances (8 bits each: upper left, upper right, lower left, lower right), instance number + 1, distance, and
// whether anything is known.
@group(1) @binding(6) var known: texture_storage_2d<rgba32uint, write>;

// Relative difference of distances that counts as the same surface.
const SAME_DISTANCE: f32 = 0.02;

// Rec. 709 luma of display values; the picture may have another size than what is shaded.
fn luma_at(texel: vec2u) -> f32 {
    let shown = texel * textureDimensions(picture_before) / vec2u(frame.target_size);
    return dot(textureLoad(picture_before, shown, 0).rgb, vec3f(0.2126, 0.7152, 0.0722));
}

fn measured(quad: vec2u) -> u32 {
    let texel = quad * 2u;
    let last = picture_of(texel).end - 1u;
    return pack4x8unorm(vec4f(
        luma_at(texel),
        luma_at(min(texel + vec2u(1u, 0u), last)),
        luma_at(min(texel + vec2u(0u, 1u), last)),
        luma_at(min(texel + vec2u(1u, 1u), last)),
    ));
}

@compute @workgroup_size(8, 8)
fn reproject(@builtin(global_invocation_id) id: vec3u) {
    let texel = id.xy * 2u;
    let picture = picture_of(texel);
    if any(texel >= picture.end) {
        return;
    }
    let who = load_words(identity, texel).xy;
    let d = load_depth(depth, texel);
    let pixel = vec2f(texel) + 0.5;
    var distance = 0.0;
    var expected = 0.0;
    if d > 0.0 {
        distance = view_distance(d);
        let position = vec4f(world_position(pixel, distance), 1.0);
        let w = (frame.views[view_of(texel)].previous_clip_from_world * position).w;
        expected = select(w, distance, frame.orthographic != 0u);
    }
    let motion = select(unpack2x16float(who.y), vec2f(0.0), who.x == 0u);
    let then = vec2i(floor((vec2f(texel) + 1.0 - motion) * 0.5));
    var found = vec4u(0u, who.x, bitcast<u32>(distance), 0u);
    let inside = all(then >= vec2i(picture.low / 2u)) && all(then < vec2i((picture.end + 1u) / 2u));
    if inside && rates.reset == 0u {
        let old = textureLoad(before, then, 0);
        let off = abs(bitcast<f32>(old.z) - expected);
        if old.y == who.x && off <= SAME_DISTANCE * expected {
            let full = (textureLoad(mask_before, then, 0).x & RATE) == 0u;
            found.x = old.x;
            found.w = old.w;
            if full {
                found.x = measured(vec2u(then));
                found.w = 1u;
            }
        }
    }
    textureStore(known, id.xy, found);
}
