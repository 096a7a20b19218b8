//! An environment that is ready to light scenes.

use std::sync::Arc;

use foveal_scene::{Environment, ImageLight};
use glam::{Quat, Vec2, Vec3, Vec3A};

use super::cube::{Cube, direction_of};
use super::irradiance::{Irradiance, irradiance_of, irradiance_of_picture, of_coefficients};
use super::picture::Equirectangular;
use super::prefilter::{Levels, halves, prefilter};
use crate::Error;

/// Texels a side of the cube map, at least and at most.
const SIDES: [usize; 2] = [256, 1024];

/// Radiance from all directions, filtered for every roughness: what
/// [`Renderer::set_environment`](crate::Renderer::set_environment) takes for
/// [`EnvironmentSource::Image`](crate::EnvironmentSource::Image). Copies share their texels.
#[derive(Clone, Debug)]
pub struct EnvironmentMap(Arc<Filtered>);

#[derive(Debug)]
struct Filtered {
    side: u32,
    /// Texels of each level as halves, side by side and row by row.
    levels: Vec<Vec<[u16; 4]>>,
    irradiance: Irradiance,
}

impl EnvironmentMap {
    /// From an equirectangular picture of linear radiance, rows top to bottom: the centre is +x,
    /// three quarters across +z, the top +y. Negative values and those that are no numbers count as
    /// 0, infinite ones as 65504.
    ///
    /// It filters the picture on the CPU, with all threads of rayon's pool: about a second on two
    /// cores for 2048 x 1024 texels.
    ///
    /// ```
    /// // A white sky over a black ground.
    /// let white_above = |i: usize| if i < 32 { [1.0; 3] } else { [0.0; 3] };
    /// let rgb: Vec<[f32; 3]> = (0..16 * 4).map(white_above).collect();
    /// assert!(foveal::EnvironmentMap::new(16, 4, &rgb).is_err(), "not twice as wide as high");
    /// let rgb: Vec<[f32; 3]> = (0..16 * 8).map(white_above).collect();
    /// let map = foveal::EnvironmentMap::new(16, 8, &rgb)?;
    /// # Ok::<(), foveal::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Environment`] where the picture is not twice as wide as high, or `rgb` has another
    /// length; [`Error::Limit`] where it has more texels than 8192 x 4096.
    pub fn new(width: u32, height: u32, rgb: &[[f32; 3]]) -> Result<Self, Error> {
        let mut picture = Equirectangular::new(width, height, rgb)?;
        let side = (picture.width() / 4).next_power_of_two();
        let side = side.clamp(SIDES[0], SIDES[1]);
        while picture.width() >= 8 * side {
            picture = picture.halved();
        }
        let samples = if picture.width() > 4 * side { 3 } else { 2 };
        let irradiance = irradiance_of_picture(&picture);
        let picture = picture.evened();
        let mut map = Self::from_radiance(side, samples, |d| picture.sample(d));
        map.set_irradiance(irradiance);
        Ok(map)
    }

    /// A scene's own sky.
    pub(crate) fn of_gradient(sky: &Environment) -> Self {
        Self::from_radiance(SIDES[0], 1, |d| gradient(sky, d).into())
    }

    /// A scene's own environment: level 0 of its cube, filtered, with its irradiance.
    pub(crate) fn of_light(light: &ImageLight) -> Self {
        let own = light.side as usize;
        // A host may have set anything; NaN becomes 0.
        let held = |v: f32| match v * light.intensity {
            v if v.is_nan() => 0.0,
            v => v.clamp(0.0, 1e9),
        };
        let bright = |t: &[f32; 3]| Vec3A::from(t.map(held));
        let cube = Cube::from_texels(own, |face, x, y| {
            bright(&light.radiance[(face * own + y) * own + x])
        });
        let side = own.next_power_of_two().clamp(SIDES[0], SIDES[1]);
        let turned = light.rotation.inverse();
        // Texel for texel where it is neither turned nor resized.
        let is_as_it_is = side == own && light.rotation == Quat::IDENTITY;
        let samples = if is_as_it_is { 1 } else { 2 };
        let mut filtered =
            Self::from_radiance(side, samples, |d| cube.sample((turned * d).normalize()));
        filtered.set_irradiance(of_coefficients(light));
        filtered
    }

    /// Of a map without copies.
    fn set_irradiance(&mut self, irradiance: Irradiance) {
        if let Some(own) = Arc::get_mut(&mut self.0) {
            own.irradiance = irradiance;
        }
    }

    /// From the radiance in each direction, a mean of `samples` x `samples` places a texel.
    pub(super) fn from_radiance(
        side: usize,
        samples: usize,
        radiance: impl Fn(Vec3) -> Vec3A + Sync,
    ) -> Self {
        let cube = Cube::from_texels(side, |face, x, y| {
            let mut sum = Vec3A::ZERO;
            for i in 0..samples * samples {
                let within = Vec2::new((i % samples) as f32, (i / samples) as f32) + 0.5;
                let at = Vec2::new(x as f32, y as f32) + within / samples as f32;
                let place = at * (2.0 / side as f32) - 1.0;
                sum += radiance(direction_of(face, place).normalize());
            }
            sum / (samples * samples) as f32
        });
        let irradiance = irradiance_of(&cube);
        Self(Arc::new(Filtered {
            side: side as u32,
            levels: prefilter(cube).iter().map(halves).collect(),
            irradiance,
        }))
    }

    /// Texels a side of level 0.
    pub(crate) fn side(&self) -> u32 {
        self.0.side
    }

    pub(crate) fn levels(&self) -> Levels {
        Levels::of(self.0.side)
    }

    /// Texels of a level, halves.
    pub(crate) fn texels(&self, level: u32) -> &[[u16; 4]] {
        &self.0.levels[level as usize]
    }

    pub(crate) fn irradiance(&self) -> &Irradiance {
        &self.0.irradiance
    }

    /// Whether both are copies of one.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// `gradient` in `shared/environment.wgsl`.
pub(crate) fn gradient(sky: &Environment, direction: Vec3) -> Vec3 {
    if direction.y >= 0.0 {
        sky.horizon.lerp(sky.zenith, direction.y.sqrt())
    } else {
        sky.horizon.lerp(sky.nadir, (-4.0 * direction.y).min(1.0))
    }
}
