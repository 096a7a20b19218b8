//! Random changes to good inputs, the same ones for the same generator.

use crate::random::Rng;

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

/// Makes one to eight changes: bits, bytes, words, pieces left out or repeated, and in text other
/// numbers and values.
pub(crate) fn mutate(bytes: &mut Vec<u8>, rng: &mut Rng) {
    for _ in 0..1 + rng.below(8) {
        mutate_once(bytes, rng);
    }
}

fn mutate_once(bytes: &mut Vec<u8>, rng: &mut Rng) {
    if bytes.is_empty() {
        bytes.push(rng.bits() as u8);
        return;
    }
    let at = rng.below(bytes.len());
    let end = (at + 1 + rng.below(64)).min(bytes.len());
    match rng.below(10) {
        0 => bytes[at] ^= 1 << rng.below(8),
        1 => bytes[at] = rng.bits() as u8,
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
        8 => replace_number(bytes, at, rng.pick(&WORDS)),
        // A piece of the input in the place of another.
        _ => {
            let copy = bytes[at..end].to_vec();
            let to = rng.below(bytes.len());
            bytes
                .iter_mut()
                .skip(to)
                .zip(copy)
                .for_each(|(b, c)| *b = c);
        }
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
