//! The bins against their twin: by subgroups and by a hash table, at every pixel and at the samples
//! of a mask.

use foveal_generate as generate;
use foveal_scene::Scene;
use glam::UVec2;

use super::bins::BIN_BYTES;
use crate::gpu::read_buffer;
use crate::shading::sample_extent;
use crate::testing::{gpu, rendered, small, texels};
use crate::{Geometry, RateSource, RateStage, Renderer, Shading, Stereo};

/// Of each bin the pixels that it should hold, `x | y << 16`.
fn twin(renderer: &Renderer, scene: &Scene, size: UVec2, mask: Option<&[u32]>) -> Vec<Vec<u32>> {
    let ids = texels::<[u32; 2]>(&renderer.targets().gbuffer.identity_view);
    let ranks = renderer.scene().materials.families().ranks();
    let mut bins = vec![Vec::new(); ranks.len()];
    for (i, id) in (0..).zip(&ids).filter(|(_, id)| id[0] > 0) {
        let texel = UVec2::new(i % size.x, i / size.x);
        let quad = texel.y / 2 * size.x.div_ceil(2) + texel.x / 2;
        let extent = mask.map_or(UVec2::ONE, |mask| sample_extent(mask[quad as usize]));
        if texel % extent == UVec2::ZERO {
            let material = scene.instances[id[0] as usize - 1].material;
            bins[ranks[material as usize] as usize].push(texel.x | texel.y << 16);
        }
    }
    bins
}

/// What the device's bins hold, sorted; they must follow one another.
fn held(renderer: &Renderer, bins: usize) -> Vec<Vec<u32>> {
    let words = |buffer| -> Vec<u32> {
        let bytes = pollster::block_on(read_buffer(gpu(), buffer)).unwrap();
        bytemuck::pod_collect_to_vec(&bytes)
    };
    let pass = renderer.geometry().triangles().expect("asked for");
    let visibility = renderer.targets().gbuffer.visibility.as_ref().unwrap();
    let (table, pixels) = (words(&pass.bins.0), words(&visibility.pixels));
    let mut next = 0;
    let mut listed = Vec::new();
    for bin in table.chunks_exact(BIN_BYTES as usize / 4).take(bins) {
        let (count, first) = (bin[0], bin[1]);
        assert_eq!(first, next, "bins follow one another");
        next += count;
        let mut held = pixels[first as usize..next as usize].to_vec();
        held.sort_unstable();
        listed.push(held);
    }
    listed
}

#[test]
fn every_listed_pixel_is_in_its_materials_bin_once() {
    let scene = generate::by_name("demo:1000").unwrap();
    let ways: &[bool] = if gpu().device.features().contains(wgpu::Features::SUBGROUP) {
        &[false, true]
    } else {
        println!("no subgroups here: the hash table alone is tested");
        &[false]
    };
    for (width, height) in [(157, 101), (16, 17), (1, 1), (3, 200)] {
        for (stereo, rated) in [
            (Stereo::Off, false),
            (Stereo::Off, true),
            (Stereo::Instanced, false),
        ] {
            let settings = small(width, height).with(|s| {
                s.geometry.path = Geometry::Visibility;
                s.stereo.mode = stereo;
            });
            let settings = if rated {
                settings.with(|s| {
                    s.shading.mode = Shading::Variable;
                    s.coarse.source = RateSource::Content;
                    s.rate.stage = RateStage::Both;
                    s.rate.force = true;
                })
            } else {
                settings
            };
            let camera = &scene.cameras[0];
            let mut renderer = rendered(&scene, camera, &settings);
            if rated {
                // Quads are shaded in full first.
                (0..5).for_each(|_| drop(renderer.redraw(camera)));
            }
            let targets = renderer.targets();
            let mask = targets.variable.as_ref().filter(|_| rated);
            let mask: Option<Vec<u32>> = mask.map(|v| texels(&v.mask));
            let target = targets.gbuffer.identity_view.texture().size();
            let size = UVec2::new(target.width, target.height);
            let expected = twin(&renderer, &scene, size, mask.as_deref());
            if !rated {
                let drawn = held(&renderer, expected.len());
                assert!(drawn == expected, "{size}, as it was drawn");
            }
            for &subgroups in ways {
                renderer.sort_again(rated, subgroups);
                let found = held(&renderer, expected.len());
                let how = format!("{size}, rated {rated}, subgroups {subgroups}");
                assert!(found == expected, "{how}");
            }
        }
    }
}
