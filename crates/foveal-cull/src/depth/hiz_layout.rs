//! Layout

/// Where in the summary of a buffer rectangles of blocks (left, top, right, bottom, inclusive) are looked up, for as many
/// lanes as `$l` has: a macro, since lanes of eight and of sixteen are different traits.
macro_rules! place_of {
    ($l:ident, $buffer:expr, $blocks:expr) => {{
        let (buffer, [x0, y0, x1, y1]) = ($buffer, $blocks);
        // The smallest `up` with `span <= 2 * 2^up`.
        let span = $l.imax($l.isub(x1, x0), $l.isub(y1, y0));
        let less = $l.imax($l.isub(span, $l.isplat(1)), $l.isplat(0));
        let third = $l.ishr(less, $l.isplat(1));
        let up = $l.ibits(third);
        let [x0, y0, x1, y1] = crate::simd::four!(i => $l.ishr([x0, y0, x1, y1][i], up));
        let most = $l.isplat(crate::depth::hiz_layout::PLACES as i32 - 1);
        let right = $l.imin($l.isub(x1, x0), most);
        let below = $l.imin($l.isub(y1, y0), most);
        let part = crate::depth::hiz_layout::part_len(buffer.blocks_x, buffer.blocks_y);
        let places = $l.isplat(crate::depth::hiz_layout::PLACES as i32);
        let places = $l.imul($l.iadd(right, $l.imul(below, places)), $l.isplat(part as i32));
        let rows = $l.isplat(crate::depth::hiz_layout::rows(buffer.blocks_x, buffer.blocks_y) as i32);
        let row = $l.iadd($l.isub(rows, $l.ishr(rows, up)), y0);
        let row = $l.imul(row, $l.isplat(buffer.blocks_x as i32));
        $l.iadd(places, $l.iadd(row, x0))
    }};
}
pub(crate) use place_of;

/// Places in a row that are joined at most.
pub(crate) const PLACES: usize = 3;
pub(super) const PARTS: usize = PLACES * PLACES;

/// Rows of places in each part: level k begins at `rows - (rows >> k)`, and has half of what is left.
pub(crate) fn rows(blocks_x: u32, blocks_y: u32) -> u32 {
    2 * blocks_x.max(blocks_y).next_power_of_two()
}

/// Places in each part; with some to spare, since joining reads beyond the last.
pub(crate) fn part_len(blocks_x: u32, blocks_y: u32) -> usize {
    let spare = PLACES as u32;
    ((rows(blocks_x, blocks_y) + spare) * blocks_x + spare) as usize
}

/// Places in all.
pub(crate) fn len(blocks_x: u32, blocks_y: u32) -> usize {
    PARTS * part_len(blocks_x, blocks_y)
}
