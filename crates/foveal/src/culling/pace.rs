//! Which frames look for what occluders hide.

use foveal_cull::Visibility;

use crate::{Culling, Settings, Shadows};

/// Frames without occluders after one whose occluders hid too little.
const REST: u32 = 30;
/// Triangles that must be hidden per rasterized triangle of an occluder.
const WORTH: u64 = 10;
/// What an object's saved draw is worth, in triangles.
const DRAW: u64 = 100;

/// Decides for each frame whether it rasterizes occluders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pace {
    Never,
    Always,
    /// As long as enough is hidden.
    WhileWorth,
    /// Not before so many frames have passed.
    Rest(u32),
}

impl Pace {
    /// `None` where nothing is culled.
    pub(super) fn new(settings: &Settings) -> Option<Self> {
        match settings.culling.mode {
            Culling::Off => None,
            Culling::Frustum => Some(Self::Never),
            // Shadow tiles hold what was seen: with other receivers in each frame they would be
            // drawn again and again.
            Culling::Auto if !has_receivers(settings) => Some(Self::WhileWorth),
            Culling::Auto | Culling::Occlusion => Some(Self::Always),
        }
    }

    pub(super) fn is_every_frame(self) -> bool {
        self == Self::Always
    }

    /// Whether the next frame rasterizes.
    pub(super) fn is_next(self) -> bool {
        matches!(self, Self::Always | Self::WhileWorth | Self::Rest(0))
    }

    /// Whether an earlier result that still holds may be kept: not where a rest has ended.
    pub(super) fn may_keep(self) -> bool {
        self != Self::Rest(0)
    }

    /// Rests no longer: what was found says nothing of what comes.
    pub(super) fn wake(&mut self) {
        if matches!(self, Self::Rest(_)) {
            *self = Self::WhileWorth;
        }
    }

    /// A frame keeps an earlier result.
    pub(super) fn keep(&mut self) {
        if let Self::Rest(frames) = self {
            *frames = frames.saturating_sub(1);
        }
    }

    /// A frame has been culled. `hidden`: triangles of each object that occluders hide. `rasterized`:
    /// triangles of these occluders.
    ///
    /// Counts decide, not times, so that a run can be repeated.
    pub(super) fn advance(&mut self, hidden: impl Iterator<Item = u32>, rasterized: u64) {
        match self {
            Self::Never | Self::Always => {}
            Self::Rest(frames) if *frames > 0 => *frames -= 1,
            Self::WhileWorth | Self::Rest(_) => {
                let hidden: u64 = hidden.map(|triangles| u64::from(triangles) + DRAW).sum();
                let is_worth = hidden > 0 && hidden >= WORTH * rasterized;
                *self = if is_worth {
                    Self::WhileWorth
                } else {
                    Self::Rest(REST)
                };
            }
        }
    }
}

/// Triangles of each object that is hidden and would be drawn.
pub(super) fn hidden_triangles<'a>(
    results: &'a [Visibility],
    triangles: &'a [u32],
    is_shown: impl Fn(u32) -> bool + 'a,
) -> impl Iterator<Item = u32> + 'a {
    (0..)
        .zip(results.iter().zip(triangles))
        .filter(move |&(object, (result, &triangles))| {
            *result == Visibility::Occluded && triangles > 0 && is_shown(object)
        })
        .map(|(_, (_, &triangles))| triangles)
}

/// Whether frames of these settings ask where shadows fall.
pub(crate) fn has_receivers(settings: &Settings) -> bool {
    settings.lighting.shadows != Shadows::Off && settings.picture.view.is_lit()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What each of some frames does, of which every one hides and rasterizes so many triangles.
    fn frames(pace: &mut Pace, count: usize, hidden: &[u32], rasterized: u64) -> Vec<bool> {
        let frame = |_| {
            let is_next = pace.is_next();
            pace.advance(hidden.iter().copied(), rasterized);
            is_next
        };
        (0..count).map(frame).collect()
    }

    fn one_in_31(count: usize) -> Vec<bool> {
        (0..count).map(|i| i % 31 == 0).collect()
    }

    #[test]
    fn ten_hidden_triangles_per_rasterized_one_are_worth_it() {
        let auto = Pace::new(&Settings::default()).unwrap();
        assert_eq!(auto, Pace::WhileWorth);
        // Two objects count for 100 triangles more each.
        assert_eq!(frames(&mut auto.clone(), 40, &[500, 300], 100), [true; 40]);
        assert_eq!(
            frames(&mut auto.clone(), 64, &[500, 299], 100),
            one_in_31(64)
        );
        assert_eq!(frames(&mut auto.clone(), 64, &[], 0), one_in_31(64));
        let mut pace = auto;
        assert_eq!(frames(&mut pace, 31, &[], 1), one_in_31(31));
        // Hides enough by then.
        assert_eq!(frames(&mut pace, 3, &[1], 1), [true; 3]);
    }

    #[test]
    fn a_result_is_not_kept_beyond_a_rest() {
        let mut pace = Pace::WhileWorth;
        pace.advance(std::iter::empty(), 1);
        for _ in 0..REST {
            assert!(pace.may_keep() && !pace.is_next());
            pace.keep();
        }
        assert!(!pace.may_keep() && pace.is_next());
        // What hides enough may be kept for as long as it holds.
        pace.advance([1].into_iter(), 1);
        pace.keep();
        assert!(pace.may_keep() && pace.is_next());
    }

    #[test]
    fn a_new_scene_ends_a_rest_and_nothing_else() {
        for (mut pace, awake) in [
            (Pace::Rest(7), Pace::WhileWorth),
            (Pace::WhileWorth, Pace::WhileWorth),
            (Pace::Always, Pace::Always),
            (Pace::Never, Pace::Never),
        ] {
            pace.wake();
            assert_eq!(pace, awake);
        }
    }
}
