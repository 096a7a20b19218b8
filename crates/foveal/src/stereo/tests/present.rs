//! The presentation's twin: what the shown picture is made from, in plain Rust.

use foveal_generate as generate;
use foveal_scene::{Camera, Scene};
use glam::{Mat3, Vec2, Vec3};

use super::two_eyes;
use crate::stereo::{EyeLayout, LensFit, eyes};
use crate::testing::{linear_of_srgb, picture, rendered, srgb_of_linear, texels};
use crate::{Output, Settings, ShownEyes};

/// The eyes' pictures in the wide target.
struct Pictures {
    settings: Settings,
    texels: Vec<[u8; 4]>,
    fits: Option<[LensFit; 2]>,
    places: ShownEyes,
    camera: Camera,
}

impl Pictures {
    fn at(&self, eye: u32, x: i32, y: i32) -> Vec3 {
        let (w, h) = (
            self.settings.picture.width as i32,
            self.settings.picture.height as i32,
        );
        let (x, y) = (x.clamp(0, w - 1), y.clamp(0, h - 1));
        let layout = EyeLayout::of(&self.settings);
        let first = y as u32 * layout.target_size().0 + eye * layout.stride;
        let texel = self.texels[first as usize + x as usize];
        Vec3::new(texel[0].into(), texel[1].into(), texel[2].into()) / 255.0
    }

    fn light(&self, eye: u32, at: Vec2) -> Vec3 {
        let size = Vec2::new(
            self.settings.picture.width as f32,
            self.settings.picture.height as f32,
        );
        let inside = at.min(size - at);
        let fade = (inside.min_element() / (0.02 * size.y)).clamp(0.0, 1.0);
        let corner = at.clamp(Vec2::NEG_ONE, size + 1.0) - 0.5;
        let (first, part) = (corner.floor(), corner - corner.floor());
        let tap = |dx: i32, dy: i32| {
            let weight = |d: i32, p: f32| if d == 1 { p } else { 1.0 - p };
            let value = self.at(eye, first.x as i32 + dx, first.y as i32 + dy);
            value.map(linear_of_srgb) * weight(dx, part.x) * weight(dy, part.y)
        };
        (tap(0, 0) + tap(1, 0) + tap(0, 1) + tap(1, 1)) * fade
    }

    fn headset(&self, x: u32, y: u32) -> Vec3 {
        let eye = u32::from(x >= self.settings.picture.width);
        let size = Vec2::new(
            self.settings.picture.width as f32,
            self.settings.picture.height as f32,
        );
        let fit = self.fits.expect("a headset")[eye as usize];
        let at = (Vec2::new((x - eye * self.settings.picture.width) as f32, y as f32) + 0.5) / size;
        let [l, r, b, t] = fit.screen;
        let p = Vec2::new(l + (r - l) * at.x, t + (b - t) * at.y);
        let u = p.length_squared();
        let seen = p * (fit.lens.seen(p.length()) / p.length());
        let borders =
            eyes(&self.settings, &self.camera).expect("sound eyes")[eye as usize].borders();
        let [left, right, bottom, top] = borders;
        let pixel = |tangent: Vec2| {
            Vec2::new(
                (tangent.x - left) / (right - left),
                (top - tangent.y) / (top - bottom),
            ) * size
        };
        let (width, height) = self.settings.picture_size();
        let shown = (Vec2::new(x as f32, y as f32) + 0.5) / Vec2::new(width as f32, height as f32);
        let (its, place) = self.places.seen(shown.to_array());
        let off = pixel(seen) - Vec2::from(place) * size;
        assert!(its == eye as usize && off.length() < 0.05, "{off}");
        let fringe = |c: [f32; 2]| seen * (c[0] + c[1] * u);
        Vec3::new(
            self.light(eye, pixel(fringe(fit.lens.red))).x,
            self.light(eye, pixel(seen)).y,
            self.light(eye, pixel(fringe(fit.lens.blue))).z,
        )
        .map(srgb_of_linear)
    }

    /// A pixel shows two columns of an eye's picture: its centre shows where they meet.
    fn assert_seen_between(&self, x: u32, y: u32, (eye, first): (u32, i32)) {
        let (width, height) = self.settings.picture_size();
        let size = Vec2::new(width as f32, height as f32);
        let shown = (Vec2::new(x as f32, y as f32) + 0.5) / size;
        let (its, [across, _]) = self.places.seen(shown.to_array());
        let off = across * size.x - (first + 1) as f32;
        assert!(its == eye as usize && off.abs() < 0.01, "{x}: {its}, {off}");
    }

    fn shown(&self, x: u32, y: u32) -> Vec3 {
        let (px, py) = (x as i32, y as i32);
        let (left, right) = (self.at(0, px, py), self.at(1, px, py));
        let weights = Vec3::new(0.299, 0.587, 0.114);
        match self.settings.stereo.output {
            Output::Flat => left,
            Output::SideBySide => {
                let eye = u32::from(x >= self.settings.picture.width);
                self.at(eye, px - (eye * self.settings.picture.width) as i32, py)
            }
            Output::SideBySideHalf => {
                let half = self.settings.picture.width.div_ceil(2);
                let eye = u32::from(x >= half);
                let first = 2 * (px - (eye * half) as i32);
                self.assert_seen_between(x, y, (eye, first));
                let [a, b] = [0, 1].map(|d| self.at(eye, first + d, py).map(linear_of_srgb));
                ((a + b) * 0.5).map(srgb_of_linear)
            }
            Output::Anaglyph => {
                Vec3::new(left.dot(weights), right.dot(weights), right.dot(weights))
            }
            Output::AnaglyphDubois => {
                let from = |rows: [[f32; 3]; 3]| Mat3::from_cols_array_2d(&rows).transpose();
                let l = from([
                    [0.4561, 0.500484, 0.176381],
                    [-0.0400822, -0.0378246, -0.0157589],
                    [-0.0152161, -0.0205971, -0.00546856],
                ]);
                let r = from([
                    [-0.0434706, -0.0879388, -0.00155529],
                    [0.378476, 0.73364, -0.0184503],
                    [-0.0721527, -0.112961, 1.2264],
                ]);
                let sum = l * left.map(linear_of_srgb) + r * right.map(linear_of_srgb);
                sum.clamp(Vec3::ZERO, Vec3::ONE).map(srgb_of_linear)
            }
            Output::Headset => self.headset(x, y),
        }
    }
}

fn assert_equals_twin(scene: &Scene, settings: Settings) {
    let camera = scene.cameras[0].clone();
    let renderer = rendered(scene, &camera, &settings);
    let eyes = eyes(&settings, &camera).expect("sound eyes");
    let pictures = Pictures {
        texels: texels(&renderer.targets().picture_view),
        fits: LensFit::of(&settings, &eyes).expect("the lens fits"),
        places: ShownEyes::new(&settings, &camera).expect("sound eyes"),
        camera,
        settings,
    };
    let (width, height) = pictures.settings.picture_size();
    let shown: Vec<[u8; 4]> = bytemuck::pod_collect_to_vec(&picture(&renderer));
    // A host that draws the picture itself sees what is read back.
    let size = renderer.picture().texture().size();
    assert_eq!((size.width, size.height), (width, height));
    assert!(texels::<[u8; 4]>(renderer.picture()) == shown);
    assert_eq!(shown.len(), (width * height) as usize);
    let mut lit = 0;
    for (i, device) in (0..).zip(&shown) {
        let twin = pictures.shown(i % width, i / width);
        for channel in 0..3 {
            let expected = (twin[channel] * 255.0).round() as i32;
            assert!(
                (i32::from(device[channel]) - expected).abs() <= 1,
                "{:?} at {}, {}: device {device:?}, twin {twin}",
                pictures.settings.stereo.output,
                i % width,
                i / width,
            );
        }
        lit += usize::from(device[1] > 40);
    }
    assert!(lit * 4 > shown.len(), "the test needs something to see");
}

#[test]
fn every_output_equals_its_twin() {
    let scene = generate::cornell();
    for output in [
        Output::Flat,
        Output::SideBySide,
        Output::SideBySideHalf,
        Output::Anaglyph,
        Output::AnaglyphDubois,
    ] {
        let settings = two_eyes(101, 77).with(|s| {
            s.stereo.output = output;
            s.stereo.ipd_m = 0.3;
        });
        assert_equals_twin(&scene, settings);
    }
    for lens in ["cardboard-v1", "dk1", "0.2,0.1,0.02,0.99,-0.01,1.01,0.02"] {
        let settings = two_eyes(101, 77).with(|s| {
            s.stereo.output = Output::Headset;
            s.stereo.lens = lens.parse().expect("it can be read");
            s.stereo.frusta = "-0.7,0.5,-0.6,0.6,-0.5,0.7,-0.6,0.6"
                .parse()
                .expect("it can be read");
        });
        assert_equals_twin(&scene, settings);
    }
}
