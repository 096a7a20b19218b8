//! The ways of shading that are compared.

use crate::changes::Changes;

/// One way of shading.
#[derive(Debug)]
pub(super) struct Way {
    pub(super) name: &'static str,
    /// What it changes in the defaults.
    pub(super) changes: Changes,
    /// What of the eye its picture depends on.
    pub(super) follows: Follows,
    /// Frames that are drawn before its picture: what follows the content needs some before it.
    pub(super) warmup: u32,
}

/// What a rate map follows of the eye.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Follows {
    Nothing,
    Gaze,
    GazeAndDisplay,
}

const fn way(name: &'static str, follows: Follows, changes: Changes) -> Way {
    Way {
        name,
        changes,
        follows,
        warmup: 0,
    }
}

const fn variable(name: &'static str, follows: Follows, changes: Changes) -> Way {
    Way {
        name,
        changes,
        follows,
        warmup: 3,
    }
}

/// The reference first.
pub(super) const WAYS: &[Way] = &[
    way("full", Follows::Nothing, &[]),
    way(
        "coarse, light",
        Follows::GazeAndDisplay,
        &[("shading", "coarse"), ("force-rate", "true")],
    ),
    way(
        "coarse, light, no history",
        Follows::GazeAndDisplay,
        &[
            ("shading", "coarse"),
            ("history", "false"),
            ("force-rate", "true"),
        ],
    ),
    way(
        "coarse, light, quality 9.3",
        Follows::GazeAndDisplay,
        &[
            ("shading", "coarse"),
            ("quality", "9.3"),
            ("force-rate", "true"),
        ],
    ),
    way(
        "coarse, light, quality 9",
        Follows::GazeAndDisplay,
        &[
            ("shading", "coarse"),
            ("quality", "9"),
            ("force-rate", "true"),
        ],
    ),
    way(
        "coarse, paper, radii",
        Follows::Gaze,
        &[
            ("shading", "coarse"),
            ("composite", "paper"),
            ("rate", "radii"),
            ("force-rate", "true"),
        ],
    ),
    variable(
        "variable",
        Follows::Nothing,
        &[
            ("shading", "variable"),
            ("rate", "content"),
            ("force-rate", "true"),
        ],
    ),
    variable(
        "variable and foveated",
        Follows::GazeAndDisplay,
        &[
            ("shading", "variable"),
            ("rate", "content"),
            ("rate-other", "foveated"),
            ("rate-combine", "coarser"),
            ("force-rate", "true"),
        ],
    ),
    way("msaa", Follows::Nothing, &[("aa", "msaa")]),
];
