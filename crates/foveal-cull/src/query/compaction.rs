//! Compaction: dense lists of the boxes that a test left undecided.
//!
//! Which boxes remain is unpredictable, so a list is filled without branches: every candidate is
//! written, and the length grows only for those that remain.

/// For each byte, the positions of its set bits, one byte per position.
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

/// Most boxes in a list.
const CAPACITY: usize = 256;

/// A dense list of box indices.
pub(super) struct Compacted {
    indices: [u8; CAPACITY + 8],
    pub(super) count: usize,
}

impl Compacted {
    pub(super) const EMPTY: Self = Self {
        indices: [0; CAPACITY + 8],
        count: 0,
    };

    #[cfg_attr(not(unoptimized), inline(always))]
    pub(super) fn indices(&self) -> &[u8] {
        &self.indices[..self.count]
    }

    /// Entry `n`. Entries past the end keep their value until they are overwritten.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(super) fn index(&self, n: usize) -> u8 {
        self.indices[n]
    }

    /// Appends the members of group `g` (eight boxes) whose bit in `wanted` is set.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(super) fn push_eight(&mut self, g: usize, wanted: usize) {
        let indices = BITS[wanted] + g as u64 * 0x0808_0808_0808_0808;
        if let Some(to) = self.indices[self.count..].first_chunk_mut() {
            *to = indices.to_le_bytes();
        }
        self.count += wanted.count_ones() as usize;
    }

    /// Drops the entries from box `end` on, which are the last ones.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(super) fn truncate_at(&mut self, end: usize) {
        while self.count > 0 && usize::from(self.indices[self.count - 1]) >= end {
            self.count -= 1;
        }
    }

    /// Appends box `n` if `wanted`, without a branch.
    #[cfg_attr(not(unoptimized), inline(always))]
    pub(super) fn push_if(&mut self, n: usize, wanted: bool) {
        self.indices[self.count] = n as u8;
        self.count += usize::from(wanted);
    }
}
