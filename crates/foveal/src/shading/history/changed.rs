//! Where lights have changed from one frame to the next.

use crate::lights::LightUniform;
use crate::shadow::{Place, add_place};

/// Most places that are told apart.
const MOST: usize = 16;
/// Most places for which it is worth finding out which lie together.
const MOST_ADDED: usize = 256;

/// Where light differs from the frame before.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) enum Changed {
    /// Nowhere.
    #[default]
    Nowhere,
    /// Within spheres: centre and radius in metres, world space.
    Within(Vec<[f32; 4]>),
    /// Anywhere: too many lights have changed, or one that lights everything.
    Everywhere,
}

impl Changed {
    /// Adds where these lights differ.
    pub(super) fn add(&mut self, before: &[LightUniform], now: &[LightUniform]) {
        let mut places = match std::mem::take(self) {
            Self::Nowhere => Vec::new(),
            Self::Within(places) => places,
            Self::Everywhere => {
                *self = Self::Everywhere;
                return;
            }
        };
        let pairs = before.iter().zip(now).filter(|(a, b)| a != b);
        let mut different: Vec<&LightUniform> = pairs.flat_map(|(a, b)| [a, b]).collect();
        let shared = before.len().min(now.len());
        different.extend(&before[shared..]);
        different.extend(&now[shared..]);
        if different.iter().any(|lamp| lamp.is_directional()) {
            *self = Self::Everywhere;
            return;
        }
        for lamp in different {
            let [x, y, z] = lamp.position;
            let place = [x, y, z, lamp.range];
            if lamp.range > 0.0 && !places.contains(&place) {
                places.push(place);
            }
        }
        *self = Self::of(places);
    }

    /// Adds these spheres.
    pub(super) fn add_places(&mut self, added: &[Place]) {
        let mut places = match std::mem::take(self) {
            Self::Nowhere => Vec::new(),
            Self::Within(places) => places,
            Self::Everywhere => {
                *self = Self::Everywhere;
                return;
            }
        };
        if added.len() > MOST_ADDED {
            *self = Self::Everywhere;
            return;
        }
        for place in added {
            add_place(&mut places, *place, MOST);
        }
        *self = Self::of(places);
    }

    fn of(places: Vec<Place>) -> Self {
        match places.len() {
            0 => Self::Nowhere,
            n if n <= MOST => Self::Within(places),
            _ => Self::Everywhere,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lamp(x: f32, range: f32) -> LightUniform {
        LightUniform {
            position: [x, 0.0, 0.0],
            range,
            radiant: [1.0; 3],
            kind: 1,
            ..LightUniform::default()
        }
    }

    fn changed(before: &[LightUniform], now: &[LightUniform]) -> Changed {
        let mut changed = Changed::default();
        changed.add(before, now);
        changed
    }

    #[test]
    fn a_lamp_that_moves_changes_where_it_was_and_where_it_is() {
        let still = [lamp(0.0, 1.0), lamp(5.0, 2.0)];
        assert_eq!(changed(&still, &still), Changed::Nowhere);
        let moved = [still[0], lamp(6.0, 2.0)];
        let places = vec![[5.0, 0.0, 0.0, 2.0], [6.0, 0.0, 0.0, 2.0]];
        assert_eq!(changed(&still, &moved), Changed::Within(places));
        assert_eq!(
            changed(&still, &still[..1]),
            Changed::Within(vec![[5.0, 0.0, 0.0, 2.0]])
        );
    }

    #[test]
    fn many_lamps_and_those_that_light_everything_change_all() {
        let some = |n: u32| (0..n).map(|i| lamp(i as f32, 1.0)).collect::<Vec<_>>();
        assert!(matches!(changed(&some(16), &[]), Changed::Within(p) if p.len() == 16));
        assert_eq!(changed(&some(17), &[]), Changed::Everywhere);
        let sun = LightUniform {
            kind: 0,
            ..lamp(0.0, 0.0)
        };
        let dim = LightUniform {
            radiant: [0.5; 3],
            ..sun
        };
        assert_eq!(changed(&[sun], &[dim]), Changed::Everywhere);
    }

    #[test]
    fn many_places_become_fewer_that_hold_them() {
        let place = |i: u32| [i as f32, (i % 7) as f32, 0.0, 0.5];
        let all: Vec<Place> = (0..40).map(place).collect();
        let mut changed = Changed::default();
        changed.add_places(&all);
        let Changed::Within(places) = changed else {
            panic!("{changed:?}");
        };
        assert!(places.len() <= MOST);
        let holds = |[x, y, z, r]: &Place, [a, b, c, s]: Place| {
            let apart = glam::Vec3::new(x - a, y - b, z - c).length();
            apart + s <= r * 1.001
        };
        for place in all {
            assert!(places.iter().any(|p| holds(p, place)), "{place:?}");
        }
        let mut changed = Changed::default();
        changed.add_places(&[place(0); MOST_ADDED + 1]);
        assert_eq!(changed, Changed::Everywhere);
    }

    #[test]
    fn changes_add_up_until_a_frame_is_drawn() {
        let mut sum = changed(&[lamp(0.0, 1.0)], &[]);
        sum.add(&[lamp(3.0, 1.0)], &[]);
        assert!(matches!(&sum, Changed::Within(places) if places.len() == 2));
        sum.add(
            &[],
            &(0..20).map(|i| lamp(i as f32, 2.0)).collect::<Vec<_>>(),
        );
        sum.add(&[lamp(0.0, 1.0)], &[]);
        assert_eq!(sum, Changed::Everywhere);
    }
}
