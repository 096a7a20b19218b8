//! What keys and pointer do: the list that F1, the line below the picture and the program's help
//! show.

/// A key's name, what it does, and a word for that in the line below the picture, which leaves keys
/// with an empty word out.
pub(crate) const ALL: [(&str, &str, &str); 26] = [
    ("F1", "this list", "all keys"),
    ("Ctrl+O", "open a scene", "open"),
    ("W A S D", "move; with Shift four times as fast", "move"),
    ("Q E, Page down/up", "move down and up", ""),
    ("Arrows", "look around; in orbit turn", ""),
    ("Drag", "look around; in orbit turn", "look"),
    (
        "Middle drag",
        "turn around the point ahead; with Shift shift it",
        "turn",
    ),
    (
        "Right drag",
        "look around; in orbit shift the point ahead",
        "",
    ),
    ("Scroll", "speed; in orbit distance", ""),
    ("F", "fly or orbit", "fly/orbit"),
    ("Click", "select an object; Esc selects none", "select"),
    (".", "bring what is selected, or else all, into view", ""),
    (
        "Alt+1, 3, 7",
        "front, right side, top; again: the opposite side",
        "",
    ),
    ("Home", "back to the first view", "start"),
    ("1 to 9", "go to a bookmark; with Ctrl set it", "bookmark"),
    ("X", "compare with the reference", "compare"),
    ("G", "gaze follows the pointer", "gaze"),
    ("B", "boxes of objects", "boxes"),
    ("Z", "depth of the occluders", "depth"),
    ("C", "freeze culling", "freeze"),
    ("H", "hide the panels", "panels"),
    ("P, F12", "take a screenshot", "picture"),
    ("V", "capture a sequence or a video", "capture"),
    ("Space", "let an animation run or rest", ""),
    ("Esc", "close or end what is on top", ""),
    (
        "Ctrl+Shift+F12",
        "lose the graphics devices: the window goes on",
        "",
    ),
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
