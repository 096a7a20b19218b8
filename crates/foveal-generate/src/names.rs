//! The names of the generated scenes.

/// The names that [`by_name`](crate::by_name) knows. `demo` also takes a size: `demo:50000`.
pub const NAMES: [&str; 8] = [
    "demo",
    "materials",
    "materials2",
    "cornell",
    "materials-grid",
    "alpha",
    "lobes",
    "yard",
];
