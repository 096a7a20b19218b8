//! Surfaces that light passes: drawn last, over what the picture shows without them, which they read
//! at the coarseness of their roughness.

use super::targets::{COARSEST, TransmissionTargets, behind_stride};
use crate::gpu::{Gpu, bind_group, bind_group_layout, sampled};
use crate::recorder::{Recorder, overwritten};
use crate::shader::{self, Screen};
use crate::shading::RADIANCE_FORMAT;
use crate::stereo::EyeLayout;
use crate::targets::Targets;

/// Copies what is behind, and makes it coarser.
#[derive(Debug)]
pub(super) struct BehindPass {
    halve: wgpu::RenderPipeline,
    level_layout: wgpu::BindGroupLayout,
    pub(super) layout: wgpu::BindGroupLayout,
}

impl BehindPass {
    pub(super) fn new(gpu: &Gpu, frame: &wgpu::BindGroupLayout) -> Self {
        let fragment = wgpu::ShaderStages::FRAGMENT;
        let float = |filterable| sampled(wgpu::TextureSampleType::Float { filterable });
        let level = [float(false)];
        let level_layout = bind_group_layout(gpu, "picture behind", fragment, &level);
        let whole = [float(true)];
        let layout = bind_group_layout(gpu, "picture behind", fragment, &whole);
        let module = shader::module(gpu, "picture behind", shader::FORWARD_HALVE);
        let halve = shader::screen(
            gpu,
            &Screen {
                groups: &[frame, &level_layout],
                targets: &[Some(RADIANCE_FORMAT.into())],
                ..Screen::of_level("picture behind", &module, "halve")
            },
        );
        Self {
            halve,
            level_layout,
            layout,
        }
    }

    /// Encodes the copies and the levels; returns the group that shaders read them by.
    pub(super) fn draw(
        &self,
        recorder: &mut Recorder<'_>,
        layout: EyeLayout,
        targets: &Targets,
        to: &TransmissionTargets,
    ) -> wgpu::BindGroup {
        let radiance = targets.radiance_view.texture();
        let depth = targets.gbuffer.depth_view.texture();
        let encoder = &mut *recorder.encoder;
        for eye in 0..layout.eyes {
            let (mut from, mut behind) =
                (radiance.as_image_copy(), to.behind.texture.as_image_copy());
            from.origin.x = eye * layout.stride;
            behind.origin.x = eye * behind_stride(layout.width);
            let picture = wgpu::Extent3d {
                width: layout.width,
                height: layout.height,
                depth_or_array_layers: 1,
            };
            encoder.copy_texture_to_texture(from, behind, picture);
        }
        if let Some(forward) = &to.depth_view {
            let forward = forward.texture().as_image_copy();
            encoder.copy_texture_to_texture(depth.as_image_copy(), forward, depth.size());
        }
        let device = &recorder.gpu.device;
        let group = |layout, view| {
            let view = [wgpu::BindingResource::TextureView(view)];
            bind_group(device, "picture behind", layout, &view)
        };
        for level in 1..=COARSEST {
            let finer = group(&self.level_layout, to.behind.level(level - 1));
            let target = [overwritten(to.behind.level(level))];
            let mut pass = recorder.render_pass("forward", &target, None);
            pass.set_pipeline(&self.halve);
            pass.set_bind_group(1, &finer, &[]);
            to.behind.draw(&mut pass, level);
        }
        group(&self.layout, &to.behind.whole)
    }
}

#[cfg(test)]
mod tests {
    use foveal_scene::{AlphaMode, Environment, Material, Scene};
    use glam::{Vec3, Vec4};

    use crate::forward::twin::{assert_near, front, glass, quads};
    use crate::testing::{radiance, rendered, small};
    use crate::{Antialiasing, EnvironmentSource, EyeFrusta, Geometry, Settings, Shading, Stereo};

    const SIDE: u32 = 31;

    fn wall(color: Vec3) -> Material {
        Material {
            base_color: color.extend(1.0),
            unlit: true,
            ..Material::default()
        }
    }

    fn settings() -> Settings {
        small(SIDE, SIDE).with(|s| s.lighting.environment = EnvironmentSource::None)
    }

    fn center_with(scene: &Scene, settings: &Settings) -> Vec3 {
        radiance(&rendered(scene, &front(), settings))[(SIDE / 2 * SIDE + SIDE / 2) as usize]
    }

    fn center(scene: &Scene) -> Vec3 {
        center_with(scene, &settings())
    }

    const WALL: Vec3 = Vec3::new(0.5, 0.4, 0.8);
    const GREEN: Vec3 = Vec3::new(0.2, 0.9, 0.5);
    const RED: Vec3 = Vec3::new(0.9, 0.3, 0.25);

    #[test]
    fn glass_shows_what_is_behind_in_its_own_colour() {
        let scene = quads(vec![wall(WALL), glass(GREEN)], &[0.0, 0.5]);
        assert_near(center(&scene), WALL * GREEN, "glass");
        let half = |factor| {
            let mut scene = scene.clone();
            if let Some(t) = &mut scene.materials[1].transmission {
                t.factor = factor;
            }
            center(&scene)
        };
        // Without light the rest is black.
        assert_near(half(0.5), 0.5 * WALL * GREEN, "half");
    }

    #[test]
    fn glass_behind_a_wall_is_hidden_and_before_another_glass_it_is_the_only_one() {
        let scene = quads(vec![wall(WALL), glass(GREEN)], &[0.5, 0.0]);
        assert_near(center(&scene), WALL, "behind");
        for (z, expected) in [([0.0, 0.5, 1.0], RED), ([0.0, 1.0, 0.5], GREEN)] {
            let scene = quads(vec![wall(WALL), glass(GREEN), glass(RED)], &z);
            assert_near(center(&scene), WALL * expected, "the nearer one");
        }
    }

    #[test]
    fn a_volume_attenuates_by_its_thickness_and_scale() {
        let tint = Vec3::new(0.5, 0.25, 1.0);
        let mut scene = quads(vec![wall(WALL), glass(Vec3::ONE)], &[0.0, 0.5]);
        if let Some(t) = &mut scene.materials[1].transmission {
            t.thickness_m = 0.3;
            t.attenuation_distance_m = 0.15;
            t.attenuation_color = tint;
        }
        assert_near(center(&scene), WALL * tint * tint, "two distances");
        scene.instances[1].world_from_object *= glam::Mat4::from_scale(Vec3::splat(0.5));
        assert_near(center(&scene), WALL * tint, "half the scale");
    }

    #[test]
    fn rough_glass_blurs_and_smooth_glass_does_not() {
        let mut scene = quads(
            vec![wall(RED), wall(GREEN), glass(Vec3::ONE)],
            &[0.0, 0.0, 0.5],
        );
        for (instance, x) in [(0, -1.0), (1, 1.0)] {
            let shift = glam::Mat4::from_translation(Vec3::new(x, 0.0, 0.0));
            scene.instances[instance].world_from_object = shift;
        }
        scene.materials[2].ior = 1.5;
        scene.materials[2].specular = 0.0;
        let beside = |roughness| {
            let mut scene = scene.clone();
            scene.materials[2].roughness = roughness;
            let all = radiance(&rendered(&scene, &front(), &settings()));
            all[(SIDE / 2 * SIDE + SIDE / 2 - 3) as usize]
        };
        assert_near(beside(0.0), RED, "smooth");
        let rough = beside(0.5);
        let mixed = rough.y > RED.y + 0.05 && rough.y < GREEN.y - 0.05;
        assert!(mixed, "{rough}");
    }

    #[test]
    fn glass_is_the_same_in_every_way_of_shading() {
        let scene = quads(vec![wall(WALL), glass(GREEN)], &[0.0, 0.5]);
        let ways: [fn(&mut Settings); 6] = [
            |s| s.geometry.path = Geometry::Visibility,
            |s| s.shading.mode = Shading::Coarse,
            |s| s.shading.mode = Shading::Variable,
            |s| s.antialiasing.mode = Antialiasing::Msaa,
            |s| s.antialiasing.mode = Antialiasing::Ssaa,
            |s| {
                s.geometry.path = Geometry::Visibility;
                s.antialiasing.mode = Antialiasing::Msaa;
                s.shading.mode = Shading::Coarse;
            },
        ];
        for (i, way) in ways.into_iter().enumerate() {
            let found = center_with(&scene, &settings().with(way));
            assert_near(found, WALL * GREEN, &format!("way {i}"));
        }
    }

    #[test]
    fn each_eye_sees_its_own_picture_behind_rough_glass() {
        // Each eye's picture is as if it were alone, at widths that no block divides.
        let mut scene = quads(
            vec![wall(RED), wall(20.0 * GREEN), glass(Vec3::ONE)],
            &[0.0, 0.0, 0.5],
        );
        for (instance, x) in [(0, -1.0), (1, 1.0)] {
            let shift = glam::Mat4::from_translation(Vec3::new(x, 0.0, 0.0));
            scene.instances[instance].world_from_object = shift;
        }
        scene.materials[2].ior = 1.5;
        scene.materials[2].roughness = 0.6;
        let ipd = 0.5;
        let (width, height) = (37, SIDE);
        let up = 20f32.to_radians().tan();
        let right = up * width as f32 / height as f32;
        let tangents = [-right, right, -up, up];
        let alone = small(width, height).with(|s| s.lighting.environment = EnvironmentSource::None);
        for mode in [Stereo::Instanced, Stereo::TwoPass] {
            let both = alone.clone().with(|s| {
                s.stereo.mode = mode;
                s.stereo.ipd_m = ipd;
                s.stereo.frusta = EyeFrusta::Tangents([tangents; 2]);
            });
            let drawn = rendered(&scene, &front(), &both);
            let target = drawn.targets().radiance_view.texture().width();
            let found = radiance(&drawn);
            for (eye, side) in [(0, -0.5), (1, 0.5)] {
                let mut camera = front();
                camera.world_from_view.w_axis.x += side * ipd;
                let expected = radiance(&rendered(&scene, &camera, &alone));
                for (i, &expected) in expected.iter().enumerate() {
                    let (x, y) = (i as u32 % width, i as u32 / width);
                    let at = y * target + eye * (target - width) + x;
                    let found = found[at as usize];
                    let off =
                        (found - expected).abs().max_element() / (1.0 + expected.max_element());
                    assert!(
                        off < 4e-3,
                        "{mode:?}, eye {eye}, {x}, {y}: {found} not {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn rough_glass_over_all_of_a_narrow_picture_shows_nothing_beside_it() {
        let mut scene = quads(vec![wall(WALL), glass(Vec3::ONE)], &[0.0, 0.5]);
        scene.materials[1].ior = 1.5;
        scene.materials[1].roughness = 1.0;
        let narrow = settings().with(|s| (s.picture.width, s.picture.height) = (5, 160));
        let drawn = rendered(&scene, &front(), &narrow);
        assert_near(radiance(&drawn)[80 * 5 + 2], WALL, "the middle");
    }

    #[test]
    fn holes_of_a_mask_are_holes_and_blended_surfaces_let_no_light_pass() {
        let mut hole = glass(GREEN);
        hole.alpha_mode = AlphaMode::Mask { cutoff: 0.5 };
        hole.base_color.w = 0.25;
        let mut scene = quads(vec![wall(WALL), hole], &[0.0, 0.5]);
        assert_near(center(&scene), WALL, "a hole");
        scene.materials[1].alpha_mode = AlphaMode::Blend;
        scene.materials[1].base_color = Vec4::new(0.0, 0.0, 0.0, 0.25);
        scene.environment = Environment::default();
        assert_near(center(&scene), 0.75 * WALL, "blended");
    }

    #[test]
    fn what_light_passes_hides_nothing() {
        let scene = quads(vec![wall(WALL), glass(GREEN)], &[0.0, 0.5]);
        assert!(scene.can_occlude(&scene.instances[0]));
        assert!(!scene.can_occlude(&scene.instances[1]));
    }
}
