// Which pixels are shaded by themselves where no sample speaks for them. In blocks of 4 x 4 pixels and
// more one of 2 x 2 pixels leads, and the others of its surface take its light. CPU twin:
// `composite/light_twin.rs`.

// Level of the blocks from which on pixels are led.
const LED_FROM: u32 = 2u;

// The leader among a pixel's 2 x 2. Neighbours have theirs at different places, so that leaders stand
// neither in rows nor in columns.
fn leader_of(texel: vec2u) -> vec2u {
    let group = texel >> vec2u(1u);
    return 2u * group + (group.yx & vec2u(1u));
}

// A pixel that is led.
fn led_entry(texel: vec2u) -> u32 {
    return texel.x | (texel.y << 16u);
}

fn led_texel(entry: u32) -> vec2u {
    return vec2u(entry, entry >> 16u) & vec2u(0xffffu);
}
