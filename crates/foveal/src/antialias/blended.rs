//! Blended surfaces at the sub-samples: drawn over nothing against the sub-samples' depth, band by
//! band, averaged, and laid over the pixels' radiance when that is known.

use super::pattern::{Band, Pattern};
use crate::gpu::{Gpu, bind_group, bind_group_layout, sampled, target, uniform};
use crate::recorder::{Recorder, drawn_over};
use crate::shader::Screen;
use crate::shading::RADIANCE_FORMAT;
use crate::{Settings, shader};

/// Bytes of a sub-sample, and of a pixel.
pub(super) const TEXEL_BYTES: u64 = 8;

/// What blended surfaces are drawn into, premultiplied.
#[derive(Debug)]
pub(crate) struct BlendedTargets {
    /// The sub-samples of one band.
    pub(crate) samples_view: wgpu::TextureView,
    /// The picture's pixels.
    average_view: wgpu::TextureView,
}

impl BlendedTargets {
    pub(super) fn new(gpu: &Gpu, texels: (u32, u32), size: (u32, u32)) -> Self {
        let none = wgpu::TextureUsages::empty();
        let view = |label, size| target(gpu, label, size, RADIANCE_FORMAT, none);
        Self {
            samples_view: view("blended sub-samples", texels),
            average_view: view("blended surfaces", size),
        }
    }

    pub(super) fn bytes(&self) -> u64 {
        let texels = |view: &wgpu::TextureView| {
            let size = view.texture().size();
            u64::from(size.width) * u64::from(size.height)
        };
        (texels(&self.samples_view) + texels(&self.average_view)) * TEXEL_BYTES
    }
}

/// Averages, and lays over.
#[derive(Debug)]
pub(super) struct BlendedStage {
    average: wgpu::RenderPipeline,
    lay_over: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
}

impl BlendedStage {
    pub(super) fn new(gpu: &Gpu, settings: &Settings, frame: &wgpu::BindGroupLayout) -> Self {
        let float = sampled(wgpu::TextureSampleType::Float { filterable: false });
        let fragment = wgpu::ShaderStages::FRAGMENT;
        let types = [uniform(), float];
        let layout = bind_group_layout(gpu, "blended", fragment, &types);
        let module = shader::module(gpu, "blended", shader::ANTIALIAS_BLENDED);
        let pipeline = |entry, blend| {
            shader::screen(
                gpu,
                &Screen {
                    groups: &[frame, &layout],
                    targets: &[Some(wgpu::ColorTargetState {
                        format: RADIANCE_FORMAT,
                        blend,
                        write_mask: wgpu::ColorWrites::ALL,
                    })],
                    constants: &Pattern::of(settings).constants(),
                    ..Screen::of("blended", &module, entry)
                },
            )
        };
        let over = wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING;
        Self {
            average: pipeline("average", None),
            lay_over: pipeline("lay_over", Some(over)),
            layout,
        }
    }

    /// Averages the band's sub-samples into its pixels.
    pub(super) fn average(
        &self,
        recorder: &mut Recorder<'_>,
        t: &BlendedTargets,
        band: Band,
        uniform: &wgpu::Buffer,
    ) {
        let group = self.group(recorder.gpu, uniform, &t.samples_view);
        let width = t.average_view.texture().width();
        let target = [drawn_over(&t.average_view)];
        let mut pass = recorder.render_pass("forward", &target, None);
        pass.set_pipeline(&self.average);
        pass.set_bind_group(1, &group, &[]);
        pass.set_scissor_rect(0, band.first_row, width, band.rows);
        pass.draw(0..3, 0..1);
    }

    /// Lays the averages over the picture's radiance; `any_band` is not looked at.
    pub(super) fn lay_over(
        &self,
        recorder: &mut Recorder<'_>,
        t: &BlendedTargets,
        any_band: &wgpu::Buffer,
        radiance: &wgpu::TextureView,
    ) {
        let group = self.group(recorder.gpu, any_band, &t.average_view);
        let mut pass = recorder.render_pass("forward", &[drawn_over(radiance)], None);
        pass.set_pipeline(&self.lay_over);
        pass.set_bind_group(1, &group, &[]);
        pass.draw(0..3, 0..1);
    }

    fn group(
        &self,
        gpu: &Gpu,
        band: &wgpu::Buffer,
        blended: &wgpu::TextureView,
    ) -> wgpu::BindGroup {
        let view = wgpu::BindingResource::TextureView(blended);
        let bindings = [band.as_entire_binding(), view];
        bind_group(&gpu.device, "blended", &self.layout, &bindings)
    }
}

#[cfg(test)]
mod tests {
    use foveal_scene::{AlphaMode, Camera, Environment, Material, Scene};
    use glam::{Vec3, Vec4};

    use crate::forward::twin::quads;
    use crate::testing::{radiance, rendered, small};
    use crate::{Antialiasing, EdgeTest, Geometry, SamplePattern, Settings};

    const SIZE: (u32, u32) = (23, 17);

    /// An opaque quad behind two glasses.
    fn glasses() -> Scene {
        let unlit = |color: Vec4| Material {
            base_color: color,
            unlit: true,
            double_sided: true,
            alpha_mode: if color.w < 1.0 {
                AlphaMode::Blend
            } else {
                AlphaMode::Opaque
            },
            ..Material::default()
        };
        let materials = [
            Vec4::new(0.1, 0.5, 0.2, 1.0),
            Vec4::new(0.9, 0.2, 0.1, 0.5),
            Vec4::new(0.1, 0.3, 0.8, 0.7),
        ];
        let z = [-0.5, 0.6, 1.1];
        let mut scene = quads(materials.map(unlit).to_vec(), &z);
        let sky = Vec3::splat(0.2);
        scene.environment = Environment {
            zenith: sky,
            horizon: sky,
            nadir: sky,
        };
        scene
    }

    /// Turned, so that edges are slanted.
    fn camera() -> Camera {
        let eye = Vec3::new(0.9, 0.7, 4.6);
        Camera::look_at(eye, Vec3::ZERO, Vec3::new(0.3, 1.0, 0.0), 0.7)
    }

    /// Where the glasses lie within the opaque quad or beside it, a picture of n times the size,
    /// averaged.
    #[test]
    fn glass_has_the_edges_of_a_picture_of_n_times_the_size() {
        let (scene, camera) = (glasses(), camera());
        let (width, height) = SIZE;
        let big = radiance(&rendered(&scene, &camera, &small(width * 2, height * 2)));
        let twin: Vec<Vec3> = (0..width * height)
            .map(|i| {
                let (x, y) = (2 * (i % width), 2 * (i / width));
                let at = |x: u32, y: u32| big[(y * width * 2 + x) as usize];
                (at(x, y) + at(x + 1, y) + at(x, y + 1) + at(x + 1, y + 1)) / 4.0
            })
            .collect();
        let off = |settings: &Settings| {
            let picture = radiance(&rendered(&scene, &camera, settings));
            let off = (picture.iter().zip(&twin)).map(|(a, b)| (a - b).abs().max_element());
            (off.clone().sum::<f32>(), off.fold(0.0, f32::max))
        };
        let (none, _) = off(&small(width, height));
        assert!(none > 1.0, "{none}");
        for (aa, edge_test, geometry) in [
            (Antialiasing::Ssaa, EdgeTest::Surface, Geometry::Gbuffer),
            (Antialiasing::Msaa, EdgeTest::Surface, Geometry::Gbuffer),
            (Antialiasing::Msaa, EdgeTest::Surface, Geometry::Visibility),
            (Antialiasing::Ssaa, EdgeTest::Surface, Geometry::Visibility),
        ] {
            let settings = small(width, height).with(|s| {
                s.antialiasing.mode = aa;
                s.antialiasing.edge_test = edge_test;
                s.geometry.path = geometry;
            });
            let (sum, most) = off(&settings);
            // Where the opaque quad ends behind glass, the two are averaged one by one, and bright
            // weighs less.
            assert!(
                sum < 0.1 * none && most < 0.1,
                "{aa:?} {geometry:?}: {sum} of {none}, {most}"
            );
        }
        let rotated = small(width, height).with(|s| {
            s.antialiasing.mode = Antialiasing::Msaa;
            s.antialiasing.pattern = SamplePattern::Rotated;
        });
        let (sum, _) = off(&rotated);
        // Its samples lie elsewhere.
        assert!(sum < 0.65 * none, "{sum} of {none}");
    }

    #[test]
    fn glass_is_the_same_in_bands() {
        let (scene, camera) = (glasses(), camera());
        let settings = small(SIZE.0, SIZE.1).with(|s| s.antialiasing.mode = Antialiasing::Msaa);
        let mut renderer = rendered(&scene, &camera, &settings);
        let whole = radiance(&renderer);
        renderer.redraw_in_bands(&camera, 5);
        assert_eq!(radiance(&renderer), whole);
    }
}
