//! What keys and pointer do: the list that F1, the line below the picture and the program's help
//! show.

/// A key as it is written on it, what it does, and what it does in a word for the line below the
/// picture; an empty word leaves it out there.
pub(crate) const ALL: [(&str, &str, &str); 16] = [
    ("F1", "this list", "all keys"),
    (
        "W A S D, arrows",
        "move; with Shift four times as fast",
        "move",
    ),
    ("Q E, Page down/up", "move down and up", ""),
    ("Drag", "look around; in orbit turn", "look"),
    ("Right drag", "in orbit shift the point that is orbited", ""),
    ("Scroll", "speed; in orbit distance", ""),
    ("F", "fly or orbit", "fly/orbit"),
    ("Home", "back to the first view", "start"),
    ("1 to 9", "go to a bookmark; with Ctrl set it", "bookmark"),
    ("X", "compare with the reference", "compare"),
    ("G", "gaze follows the pointer", "gaze"),
    ("B", "boxes of objects", "boxes"),
    ("Z", "depth of the occluders", "depth"),
    ("C", "freeze culling", "freeze"),
    (
        "H, P",
        "hide the panels; take a screenshot",
        "panels, picture",
    ),
    ("Space", "let an animation run or rest", ""),
];

/// The list as lines of text, for a program's help.
#[must_use]
pub fn help() -> String {
    let width = ALL.iter().map(|(key, ..)| key.len()).max().unwrap_or(0);
    let line = |(key, does, _): &(&str, &str, &str)| format!("  {key:<width$}  {does}\n");
    format!(
        "Keys in the window:\n{}",
        ALL.iter().map(line).collect::<String>()
    )
}
