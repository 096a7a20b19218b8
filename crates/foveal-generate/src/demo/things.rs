//! All things that the demo places.

use super::{goods, houses, lanterns, materials, square, stalls, walls};
use crate::build::SceneBuilder;

/// All things that can be placed.
#[derive(Debug)]
pub(super) struct Kit {
    pub(super) houses: houses::Houses,
    pub(super) stalls: stalls::Stalls,
    pub(super) goods: goods::Goods,
    pub(super) lanterns: lanterns::Lanterns,
    pub(super) walls: walls::Walls,
    pub(super) furniture: square::Furniture,
}

impl Kit {
    pub(super) fn new(scene: &mut SceneBuilder) -> Self {
        let m = materials::Materials::new(scene);
        Self {
            houses: houses::Houses::new(scene, &m),
            stalls: stalls::Stalls::new(scene, &m),
            goods: goods::Goods::new(scene, &m),
            lanterns: lanterns::Lanterns::new(scene, &m),
            walls: walls::Walls::new(scene, &m),
            furniture: square::Furniture::new(scene, &m),
        }
    }
}
