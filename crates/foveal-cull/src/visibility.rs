//! Visibility

/// What became of a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Visibility {
    /// May be seen: draw it.
    Visible = 0,
    /// Outside the view frustum (or beyond the far plane, or nearer than the near plane).
    Outside = 1,
    /// Below the size threshold.
    Small = 2,
    /// Hidden behind occluders.
    Occluded = 3,
}

impl Visibility {
    /// Whether it must be drawn.
    #[must_use]
    pub fn is_visible(self) -> bool {
        self == Self::Visible
    }
}
