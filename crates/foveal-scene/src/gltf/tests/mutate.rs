//! Random changes to good inputs, the same ones for the same seed.
//!
//! How long the fuzz tests run is said by `FOVEAL_FUZZ_SECONDS` (each; 2 without), where they begin
//! by `FOVEAL_FUZZ_SEED`.

use std::time::{Duration, Instant};

/// SplitMix64 (Steele, Lea and Flood 2014).
pub(crate) struct Rng(pub(crate) u64);

impl Rng {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Below `n`, which is at least 1.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }

    fn pick<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.below(list.len())]
    }
}

/// Numbers at the borders of types and of limits.
const NUMBERS: [&str; 22] = [
    "-1",
    "0",
    "1",
    "2",
    "3",
    "7",
    "255",
    "256",
    "5121",
    "5123",
    "5126",
    "65535",
    "65536",
    "2147483647",
    "4294967295",
    "4294967296",
    "18446744073709551615",
    "1e38",
    "1e309",
    "-0.0",
    "0.5",
    "1e-45",
];
const WORDS: [&str; 14] = [
    "null",
    "[]",
    "{}",
    "\"\"",
    "true",
    "\"MAT4\"",
    "\"SCALAR\"",
    "[[[[",
    "}",
    "nan",
    "inf",
    "\"\\u0000\"",
    "\"../x\"",
    "\"data:,\"",
];
const INTEGERS: [u32; 10] = [
    0,
    1,
    2,
    3,
    0x7F,
    0xFFFF,
    0x7FFF_FFFF,
    0x8000_0000,
    0xFFFF_FFFF,
    0x7FC0_0000,
];

/// One to eight changes.
pub(crate) fn mutate(bytes: &mut Vec<u8>, rng: &mut Rng) {
    for _ in 0..1 + rng.below(8) {
        mutate_once(bytes, rng);
    }
}

fn mutate_once(bytes: &mut Vec<u8>, rng: &mut Rng) {
    if bytes.is_empty() {
        bytes.push(rng.next() as u8);
        return;
    }
    let at = rng.below(bytes.len());
    let end = (at + 1 + rng.below(64)).min(bytes.len());
    match rng.below(9) {
        0 => bytes[at] ^= 1 << rng.below(8),
        1 => bytes[at] = rng.next() as u8,
        2 => {
            let word = rng.pick(&INTEGERS).to_le_bytes();
            bytes
                .iter_mut()
                .skip(at)
                .zip(word)
                .for_each(|(b, w)| *b = w);
        }
        3 => drop(bytes.drain(at..end)),
        4 => {
            let copy = bytes[at..end].to_vec();
            let to = rng.below(bytes.len());
            bytes.splice(to..to, copy);
        }
        5 => bytes.truncate(at),
        // In text: another number, or another value.
        6 | 7 => replace_number(bytes, at, rng.pick(&NUMBERS)),
        _ => replace_number(bytes, at, rng.pick(&WORDS)),
    }
}

/// Replaces the first number from `at` on.
fn replace_number(bytes: &mut Vec<u8>, at: usize, with: &str) {
    let digit = |b: &u8| b.is_ascii_digit() || b"-+.eE".contains(b);
    let Some(start) = bytes[at..].iter().position(u8::is_ascii_digit) else {
        return;
    };
    let start = at + start;
    let len = bytes[start..].iter().take_while(|b| digit(b)).count();
    bytes.splice(start..start + len, with.bytes());
}

/// Gives `check` changed seeds until the time is over; `check` panics at what must not be. No input
/// may take five seconds (sixty where the machine is busy with other tests).
pub(crate) fn run<T: Clone>(
    name: &str,
    seeds: &[T],
    mutate: impl Fn(&mut T, &mut Rng),
    check: impl Fn(&T),
) {
    let read = |name: &str| std::env::var(name).ok().and_then(|v| v.parse::<u64>().ok());
    let seconds = read("FOVEAL_FUZZ_SECONDS").unwrap_or(2);
    let first = read("FOVEAL_FUZZ_SEED").unwrap_or(0);
    let begin = Instant::now();
    let mut number = first;
    while begin.elapsed() < Duration::from_secs(seconds) {
        let mut rng = Rng(number);
        let mut input = seeds[rng.below(seeds.len())].clone();
        mutate(&mut input, &mut rng);
        let started = Instant::now();
        let place = Place { name, number };
        check(&input);
        std::mem::forget(place);
        let took = started.elapsed();
        assert!(took.as_secs() < 60, "{name}: input {number} took {took:?}");
        number += 1;
    }
    eprintln!("{name}: {} inputs", number - first);
}

/// Says which input it was when a check panics.
struct Place<'a> {
    name: &'a str,
    number: u64,
}

impl Drop for Place<'_> {
    fn drop(&mut self) {
        eprintln!(
            "{}: it was input {}; FOVEAL_FUZZ_SEED={} begins with it",
            self.name, self.number, self.number
        );
    }
}
