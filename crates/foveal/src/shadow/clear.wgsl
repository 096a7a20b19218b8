// Empties a tile of the atlas: depth 0, where nothing is.

#import shared/full_screen.wgsl

@fragment
fn clear() {}
