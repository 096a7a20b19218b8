//! Random numbers: a plain generator, and one that is steered by an input's bytes.

/// SplitMix64 (Steele, Lea and Flood 2014).
#[derive(Clone, Debug)]
pub(crate) struct Rng(pub(crate) u64);

impl Rng {
    /// The next 64 bits.
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Below `n`; 0 where `n` is 0.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        (self.bits() % n.max(1) as u64) as usize
    }

    pub(crate) fn pick<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.below(list.len())]
    }
}

/// Eight inputs of so many random bytes, for targets that make their own scenes.
pub(crate) fn random_bytes(count: usize) -> Vec<Vec<u8>> {
    let input = |seed| {
        let mut rng = Rng(seed);
        (0..count).map(|_| rng.bits() as u8).collect()
    };
    (0..8).map(input).collect()
}

/// Choices that an input's bytes make: small ones cost a byte, so that a fuzzer that watches the
/// program's branches can change one at a time. When the bytes are used up, choices follow from a
/// hash of all of them.
#[derive(Clone, Debug)]
pub(crate) struct Choices<'a> {
    bytes: &'a [u8],
    rest: Rng,
}

impl<'a> Choices<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        // FNV-1a.
        let hash = bytes.iter().fold(0xCBF2_9CE4_8422_2325, |hash: u64, b| {
            (hash ^ u64::from(*b)).wrapping_mul(0x0100_0000_01B3)
        });
        Self {
            bytes,
            rest: Rng(hash),
        }
    }

    fn byte(&mut self) -> u8 {
        match self.bytes.split_first() {
            Some((first, rest)) => {
                self.bytes = rest;
                *first
            }
            None => self.rest.bits() as u8,
        }
    }

    pub(crate) fn bits(&mut self) -> u64 {
        match self.bytes.split_first_chunk() {
            Some((first, rest)) => {
                self.bytes = rest;
                u64::from_le_bytes(*first)
            }
            None => self.rest.bits(),
        }
    }

    /// Below `n`, which is at least 1.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        if n <= 256 {
            usize::from(self.byte()) * n / 256
        } else {
            (self.bits() % n as u64) as usize
        }
    }

    pub(crate) fn one_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }

    pub(crate) fn pick<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.below(list.len())]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_make_the_first_choices_and_all_of_them_the_others() {
        let mut choices = Choices::new(&[0, 255, 128, 7]);
        let first: Vec<usize> = (0..3).map(|_| choices.below(10)).collect();
        assert_eq!(first, [0, 9, 5]);
        let after = |bytes: &[u8]| {
            let mut choices = Choices::new(bytes);
            for _ in bytes {
                choices.byte();
            }
            choices.bits()
        };
        assert_eq!(after(&[1, 2]), after(&[1, 2]));
        assert_ne!(after(&[1, 2]), after(&[1, 3]));
    }
}
