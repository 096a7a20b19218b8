//! The hasher of baking's maps: one multiplication per word.

use core::hash::{BuildHasher, Hasher};
use std::collections::hash_map::RandomState;

/// Makes hashers with a seed of its own, so that no mesh is slow in every process. On targets
/// without random numbers, as `wasm32-unknown-unknown`, the standard library's seeds are the same in
/// every process.
#[derive(Clone, Copy, Debug)]
pub(super) struct WordHash {
    seed: u64,
}

impl Default for WordHash {
    fn default() -> Self {
        Self {
            seed: RandomState::new().hash_one(0u32),
        }
    }
}

impl BuildHasher for WordHash {
    type Hasher = WordHasher;

    fn build_hasher(&self) -> WordHasher {
        WordHasher(self.seed)
    }
}

/// Folds each word into its state by a product of 128 bits.
#[derive(Clone, Copy, Debug)]
pub(super) struct WordHasher(u64);

impl Hasher for WordHasher {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.write_u64(u64::from(*byte));
        }
    }

    fn write_u32(&mut self, word: u32) {
        self.write_u64(u64::from(word));
    }

    fn write_u64(&mut self, word: u64) {
        let product = u128::from(self.0 ^ word) * 0x9e37_79b9_7f4a_7c15;
        self.0 = (product >> 64) as u64 ^ product as u64;
    }
}

/// Three words as a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Words3(pub(super) [u32; 3]);

impl core::hash::Hash for Words3 {
    fn hash<H: Hasher>(&self, state: &mut H) {
        let [a, b, c] = self.0;
        state.write_u64(u64::from(a) << 32 | u64::from(b));
        state.write_u32(c);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    /// Hashes of points on a lattice, which differ in few bits, spread over all low and high bits.
    #[test]
    fn points_of_a_lattice_spread() {
        let hash = WordHash::default();
        let (mut low, mut high) = (HashSet::new(), HashSet::new());
        for i in 0..4096u32 {
            let point = [i % 16, i / 16 % 16, i / 256].map(|v| (v as f32 * 0.5).to_bits());
            let h = hash.hash_one(Words3(point));
            low.insert(h & 0xffff);
            high.insert(h >> 48);
        }
        // Of 4,096 random numbers of 16 bits, 3,969 differ in the mean.
        assert!(
            low.len() > 3_800 && high.len() > 3_800,
            "{} {}",
            low.len(),
            high.len()
        );
    }
}
