// Where each eye's picture lies in the picture behind.

#import shared/frame.wgsl

// First column of the right eye's picture there. No texel of the coarsest level, 6, spans both eyes'.
fn behind_stride() -> u32 {
    return (u32(frame.size.x) + 63u) & 0xffffffc0u;
}
