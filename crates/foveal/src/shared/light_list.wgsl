// The scene's lights and the clusters' bits.

#export shared/light_table.wgsl
#ifdef REDUCED
#import gpu/table.wgsl
#expects cluster_table
#else
#expects cluster_lights
#endif

#ifdef REDUCED
fn cluster_word(index: u32) -> u32 {
    let words = textureLoad(cluster_table, table_texel(index / 4u), 0);
    return words[index % 4u];
}
#else
fn cluster_word(index: u32) -> u32 {
    return cluster_lights[index];
}
#endif
