// Where an instance's triangles and its material lie. Rust: `scene/geometry.rs`.

#ifdef TABLES
#import gpu/table.wgsl
#expects place_table
#else
#expects places
#endif

struct Place {
    // Of the instance's mesh among the indices.
    first_index: u32,
    // What its indices count from.
    base_vertex: u32,
    material: u32,
    // Where the pixels that show it are sorted to.
    bin: u32,
}

fn place_of(instance: u32) -> Place {
#ifdef TABLES
    let words = textureLoad(place_table, table_texel(instance), 0);
    return Place(words.x, words.y, words.z, words.w);
#else
    return places[instance];
#endif
}
