//! The layout of the HiZ table: the farthest depth of any rectangle of blocks in one look-up.
//!
//! Level 0 has one cell per block, level k one cell per 2^k x 2^k blocks. The usual pyramid
//! (Greene, Kass and Miller 1993) needs up to four look-ups for a rectangle that straddles cells.
//! Here each level is stored nine times, in parts: in part `right + 3 * below` each cell is joined
//! with that many neighbours to the right and below. A rectangle is therefore found by one look-up,
//! at the finest level where it touches at most three cells in a row.

/// Index in the HiZ table for rectangles of blocks (left, top, right, bottom, inclusive), one per
/// lane of `$l`. A macro, which lanes of eight and of sixteen share.
macro_rules! hiz_index {
    ($l:ident, $buffer:expr, $blocks:expr) => {{
        let (buffer, [x0, y0, x1, y1]) = ($buffer, $blocks);
        // The smallest `up` with `span <= 2 * 2^up`.
        let span = (x1 - x0).max(y1 - y0);
        let less = (span - 1).max($l.int(0));
        let third = less >> 1;
        let up = third.significant_bits();
        let [x0, y0, x1, y1] = crate::simd::four!(i => [x0, y0, x1, y1][i] >> up);
        let most = $l.int(crate::depth::hiz_layout::MAX_JOINED as i32 - 1);
        let right = (x1 - x0).min(most);
        let below = (y1 - y0).min(most);
        let part = crate::depth::hiz_layout::part_len(buffer.blocks_x, buffer.blocks_y);
        let places = $l.int(crate::depth::hiz_layout::MAX_JOINED as i32);
        let places = (right + below * places) * part as i32;
        let rows = $l.int(crate::depth::hiz_layout::rows(buffer.blocks_x, buffer.blocks_y) as i32);
        let row = rows - (rows >> up) + y0;
        let row = row * buffer.blocks_x as i32;
        places + (row + x0)
    }};
}
pub(crate) use hiz_index;

/// Most cells in a row that are joined.
pub(crate) const MAX_JOINED: usize = 3;
pub(super) const PARTS: usize = MAX_JOINED * MAX_JOINED;

/// Rows of cells in each part. Level k begins at row `rows - (rows >> k)`.
pub(crate) fn rows(blocks_x: u32, blocks_y: u32) -> u32 {
    2 * blocks_x.max(blocks_y).next_power_of_two()
}

/// Cells in each part, with some spare: joining reads beyond the last cell.
pub(crate) fn part_len(blocks_x: u32, blocks_y: u32) -> usize {
    let spare = MAX_JOINED as u32;
    ((rows(blocks_x, blocks_y) + spare) * blocks_x + spare) as usize
}

/// Cells of the whole table.
pub(crate) fn len(blocks_x: u32, blocks_y: u32) -> usize {
    PARTS * part_len(blocks_x, blocks_y)
}
