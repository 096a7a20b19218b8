// What shaders know of the tiles of the shadow atlas. Rust: `shadow/records.rs`.

#ifdef TABLES
#import gpu/table.wgsl
#expects shadow_table
#else
#expects shadow_rows
#endif

// 0: lights shine through everything; 1: one comparison; 2: nine, blended between texels; 3: as many
// as soften by the distance to what casts the shadow.
override SHADOWS: u32 = 0u;

const SHADOWS_SOFT: u32 = 2u;
const SHADOWS_CONTACT: u32 = 3u;
// Rows of a light's record. Rust: `shadow/records.rs`.
const SHADOW_ROWS: u32 = 2u;
// As `BORDER` in `shadow/volume.rs`.
const SHADOW_BORDER: f32 = 4.0;

#ifdef TABLES
fn shadow_words(row: u32) -> vec4u {
    return textureLoad(shadow_table, table_texel(row), 0);
}
#else
fn shadow_words(row: u32) -> vec4u {
    return shadow_rows[row];
}
#endif

fn shadow_row(row: u32) -> vec4f {
    return bitcast<vec4f>(shadow_words(row));
}

// A tile in texels of the atlas: its upper left corner, and its side, which is 0 where there is
// none.
struct ShadowTile {
    corner: vec2f,
    side: f32,
    // It is as coarse as the samples that show it: its filter is a texel wide, not three.
    is_narrow: bool,
}

fn shadow_tile(word: u32) -> ShadowTile {
    let corner = vec2f(vec2u(word, word >> 10u) & vec2u(0x3ffu)) * 16.0;
    return ShadowTile(corner, select(0.0, f32(1u << ((word >> 20u) & 31u)), word != 0u), (word & 0x2000000u) != 0u);
}
