//! Whether the geometry passes find motion.

use crate::{DebugView, Settings, Shading};

/// `MOTION` in `shared/vertex.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Motion {
    Omitted,
    Written,
}

impl Motion {
    /// What these settings need.
    pub(crate) fn wanted_by(settings: &Settings) -> Self {
        let reprojects = settings.shading.mode == Shading::Variable || settings.keeps_light();
        if reprojects || settings.picture.view == DebugView::Motion {
            Self::Written
        } else {
            Self::Omitted
        }
    }

    /// The constant of shaders with `shared/vertex.wgsl`.
    pub(crate) fn constant(self) -> (&'static str, f64) {
        ("MOTION", f64::from(u8::from(self == Self::Written)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motion_is_found_where_something_asks_for_it() {
        let mut settings = Settings::default();
        settings.shading.mode = Shading::Full;
        assert_eq!(Motion::wanted_by(&settings), Motion::Omitted);
        settings.shading.mode = Shading::Variable;
        assert_eq!(Motion::wanted_by(&settings), Motion::Written);
        settings.shading.mode = Shading::Coarse;
        assert_eq!(Motion::wanted_by(&settings), Motion::Written);
        settings.coarse.history = false;
        assert_eq!(Motion::wanted_by(&settings), Motion::Omitted);
        settings.picture.view = DebugView::Motion;
        assert_eq!(Motion::wanted_by(&settings), Motion::Written);
    }
}
