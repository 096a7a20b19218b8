//! Where a block is sampled: the twin of `sample_texel` in `shared/blocks.wgsl`.

/// The texel that candidate `candidate` (0: the centre, 1 to 4: near the corners) of a block looks
/// at.
pub(crate) fn sample_texel(
    block: (u32, u32),
    level: u32,
    candidate: u32,
    size: (u32, u32),
) -> (u32, u32) {
    let side = 1 << level;
    let within = |bit: u32| match candidate {
        0 => side / 2,
        c => side * (1 + 2 * ((c - 1) >> bit & 1)) / 4,
    };
    (
        ((block.0 << level) + within(0)).min(size.0 - 1),
        ((block.1 << level) + within(1)).min(size.1 - 1),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sample_lies_in_its_block_and_in_the_picture() {
        let size = (513, 300);
        for level in 0..=8 {
            for block in [(0, 0), ((size.0 - 1) >> level, (size.1 - 1) >> level)] {
                for candidate in 0..5 {
                    let (x, y) = sample_texel(block, level, candidate, size);
                    assert!(x < size.0 && y < size.1);
                    assert_eq!((x >> level, y >> level), block, "level {level}");
                }
            }
        }
    }
}
