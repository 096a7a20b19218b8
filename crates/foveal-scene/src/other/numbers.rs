//! Numbers in the text of OBJ and PLY files.

use std::str::FromStr;

/// A number as Rust and C write it.
pub(super) fn parsed<T: FromStr>(word: &str) -> Result<T, String> {
    without_payload(word)
        .parse()
        .map_err(|_| not_a_number(word))
}

/// A whole number, which may be written as one of all numbers: `255.0`, `3e0`.
pub(super) fn whole<T: FromStr + TryFrom<i64>>(word: &str) -> Result<T, String> {
    let written_otherwise = |_| {
        let number: f64 = parsed(word)?;
        // What is beyond the range of i64 is beyond those of all types here.
        let whole = (number.fract() == 0.0).then_some(number as i64);
        let fitting = whole.and_then(|whole| T::try_from(whole).ok());
        fitting.ok_or_else(|| not_whole::<T>(word))
    };
    word.parse().or_else(written_otherwise)
}

/// What is said of a number that should be a whole one, with few bits.
fn not_whole<T>(word: &str) -> String {
    let word: String = word.chars().take(40).collect();
    let bits = 8 * size_of::<T>();
    format!("\"{word}\" is not a whole number of {bits} bits")
}

/// What is said of a word that should be a number.
pub(super) fn not_a_number(word: &str) -> String {
    let word: String = word.chars().take(40).collect();
    format!("\"{word}\" is not a number")
}

/// A NaN without what C may write behind it: `-nan(ind)`, `nan(0x8000)`.
fn without_payload(word: &str) -> &str {
    let is_nan = |number: &str| {
        let name = number.trim_start_matches(['+', '-']);
        name.eq_ignore_ascii_case("nan")
    };
    let cut = word.split_once('(').map(|(number, _)| number);
    cut.filter(|number| is_nan(number)).unwrap_or(word)
}
