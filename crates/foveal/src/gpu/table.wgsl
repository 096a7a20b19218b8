// Tables of words in textures: `gpu/table.rs` says where they are.

const TABLE_WIDTH: u32 = 1024u;

// Where a table's texel lies, four words each.
fn table_texel(index: u32) -> vec2u {
    return vec2u(index % TABLE_WIDTH, index / TABLE_WIDTH);
}
