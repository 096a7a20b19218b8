//! Lists of boxes that are left to be looked at: what belongs into one is put there without a branch, since it cannot be
//! foreseen.

/// The numbers of the bits that are set in a byte, a byte each.
const BITS: [u64; 256] = {
    let mut bits = [0; 256];
    let mut n = 0;
    while n < 256 {
        let (mut i, mut count) = (0, 0);
        while i < 8 {
            if n >> i & 1 != 0 {
                bits[n] |= i << (8 * count);
                count += 1;
            }
            i += 1;
        }
        n += 1;
    }
    bits
};

/// Most boxes that are gone through together.
const MOST: usize = 256;

/// Boxes that are left: their numbers.
pub(super) struct List {
    numbers: [u8; MOST + 8],
    pub(super) count: usize,
}

impl List {
    pub(super) const NONE: Self = Self {
        numbers: [0; MOST + 8],
        count: 0,
    };

    #[inline(always)]
    pub(super) fn numbers(&self) -> &[u8] {
        &self.numbers[..self.count]
    }

    /// Number `n`, which may have been dropped since.
    #[inline(always)]
    pub(super) fn number(&self, n: usize) -> u8 {
        self.numbers[n]
    }

    /// Adds those of group `g` whose bit is set.
    #[inline(always)]
    pub(super) fn add_eight(&mut self, g: usize, wanted: usize) {
        let numbers = BITS[wanted] + g as u64 * 0x0808_0808_0808_0808;
        if let Some(to) = self.numbers[self.count..].first_chunk_mut() {
            *to = numbers.to_le_bytes();
        }
        self.count += wanted.count_ones() as usize;
    }

    /// Drops numbers from `end` on, which come last.
    #[inline(always)]
    pub(super) fn end(&mut self, end: usize) {
        while self.count > 0 && usize::from(self.numbers[self.count - 1]) >= end {
            self.count -= 1;
        }
    }

    /// Adds a box if `wanted`.
    #[inline(always)]
    pub(super) fn add(&mut self, n: usize, wanted: bool) {
        self.numbers[self.count] = n as u8;
        self.count += usize::from(wanted);
    }
}
