//! Numbers in the text of OBJ and PLY files.

use std::str::FromStr;

/// A number as Rust and C write it.
pub(super) fn parsed<T: FromStr>(word: &str) -> Result<T, String> {
    without_payload(word)
        .parse()
        .map_err(|_| not_a_number(word))
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
