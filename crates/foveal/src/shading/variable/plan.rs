//! What a frame of variable shading does.

/// What a frame does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct VariablePlan {
    /// Shades at a rate; else in full.
    pub(crate) active: bool,
    /// Shades in full besides, to compare.
    pub(crate) compares: bool,
}
