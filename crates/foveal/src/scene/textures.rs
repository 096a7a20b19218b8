//! Textures on the device: those of one shape are layers of one array.
//!
//! Geometry passes bind single layers. What evaluates the materials of many triangles at once binds
//! whole arrays (`families.rs`), because no device need offer an index into textures that differs
//! from pixel to pixel.

use std::borrow::Cow;
use std::collections::HashMap;

use foveal_scene::{ColorSpace, Encoding, Texture};

use super::uploads::Uploads;
use crate::Error;
use crate::gpu::{Gpu, layer_of, layers_of};

/// How large arrays of textures may become, and what they may hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ArrayLimits {
    /// Layers of one array, 1 to 256.
    pub(crate) layers: u32,
    /// Bytes of one array, but for textures that are larger by themselves.
    pub(crate) bytes: u64,
    /// Whether the device reads blocks; where not, they are decoded on the way to it.
    pub(crate) blocks: bool,
}

impl ArrayLimits {
    /// What `MaterialUniform::layers` has room for.
    const MOST_LAYERS: u32 = 256;
    /// A driver may refuse a single texture of much more, though there is room for many of this
    /// size.
    const MOST_BYTES: u64 = 256 << 20;

    /// What this device allows. WebGL has no view of one layer: there each texture is alone.
    pub(crate) fn of(gpu: &Gpu) -> Self {
        let layers = gpu.device.limits().max_texture_array_layers;
        Self {
            layers: if gpu.is_reduced() {
                1
            } else {
                layers.min(Self::MOST_LAYERS)
            },
            bytes: Self::MOST_BYTES,
            blocks: gpu.reads_blocks(),
        }
    }
}

/// What the textures of one array have in common; sizes in texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Shape {
    color_space: ColorSpace,
    encoding: Encoding,
    width: u32,
    height: u32,
    levels: u32,
}

impl Shape {
    /// Of `texture` without the levels that are larger than the device's limit, and how many those
    /// are. Without `blocks`, and where the rest is not of whole ones, it is one of texels.
    fn of(texture: &Texture, limit: u32, blocks: bool) -> Result<(Self, usize), Error> {
        check_levels(texture)?;
        let side = |level: usize| texture.level_size(level);
        let fitting = (0..texture.levels.len()).find(|&l| side(l).0.max(side(l).1) <= limit);
        let Some(first) = fitting else {
            if texture.levels.is_empty() {
                let texture = texture.name.clone();
                return Err(Error::NoTexels { texture });
            }
            return Err(Error::Limit {
                what: format!("the larger side of the texture '{}'", texture.name),
                value: u64::from(texture.width.max(texture.height)),
                limit: u64::from(limit),
                hint: String::new(),
            });
        };
        let (width, height) = side(first);
        let keeps = blocks && texture.encoding.fits(width, height);
        let shape = Self {
            color_space: texture.color_space,
            encoding: if keeps {
                texture.encoding
            } else {
                Encoding::Rgba8
            },
            width,
            height,
            levels: (texture.levels.len() - first) as u32,
        };
        Ok((shape, first))
    }

    fn extent(self, level: u32, layers: u32) -> wgpu::Extent3d {
        wgpu::Extent3d {
            width: (self.width >> level).max(1),
            height: (self.height >> level).max(1),
            depth_or_array_layers: layers,
        }
    }

    /// Of one layer.
    fn bytes(self) -> u64 {
        let levels = (0..self.levels).map(|level| self.extent(level, 1));
        levels
            .map(|e| self.encoding.level_bytes(e.width, e.height))
            .sum()
    }

    fn format(self) -> wgpu::TextureFormat {
        use wgpu::TextureFormat as Format;
        match (self.encoding, self.color_space) {
            (Encoding::Rgba8, ColorSpace::Srgb) => Format::Rgba8UnormSrgb,
            (Encoding::Rgba8, ColorSpace::Linear) => Format::Rgba8Unorm,
            (Encoding::Bc1, ColorSpace::Srgb) => Format::Bc1RgbaUnormSrgb,
            (Encoding::Bc1, ColorSpace::Linear) => Format::Bc1RgbaUnorm,
            (Encoding::Bc7, ColorSpace::Srgb) => Format::Bc7RgbaUnormSrgb,
            (Encoding::Bc7, ColorSpace::Linear) => Format::Bc7RgbaUnorm,
            // There is no sRGB of one channel or two.
            (Encoding::Bc4, _) => Format::Bc4RUnorm,
            (Encoding::Bc5, _) => Format::Bc5RgUnorm,
        }
    }
}

/// Refuses levels that are not those of the texture's size.
fn check_levels(texture: &Texture) -> Result<(), Error> {
    let Texture { width, height, .. } = *texture;
    let wrong = |what: String| {
        let name = &texture.name;
        Err(Error::Scene {
            cause: format!("the texture '{name}' of {width} x {height} texels {what}"),
        })
    };
    let most = width.max(height).max(1).ilog2() as usize + 1;
    let levels = texture.levels.len();
    if levels > most {
        return wrong(format!("has {levels} levels, and there are {most} at most"));
    }
    for (number, level) in texture.levels.iter().enumerate() {
        let (width, height) = texture.level_size(number);
        let expected = texture.encoding.level_bytes(width, height);
        if level.len() as u64 != expected {
            let found = level.len();
            return wrong(format!(
                "has {found} bytes at level {number}, which takes {expected}"
            ));
        }
    }
    Ok(())
}

/// Where a texture lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Place {
    pub(crate) array: u32,
    pub(crate) layer: u32,
}

/// Each shape's place, and the arrays: their shape and number of layers. Equal shapes share an
/// array while it has room.
fn arrange(shapes: &[Shape], limits: ArrayLimits) -> (Vec<Place>, Vec<(Shape, u32)>) {
    let mut arrays: Vec<(Shape, u32)> = Vec::new();
    let mut open: HashMap<Shape, usize> = HashMap::new();
    let place = |&shape: &Shape| {
        let room = (limits.bytes / shape.bytes().max(1)).clamp(1, u64::from(limits.layers));
        let array = match open.get(&shape) {
            Some(&array) if u64::from(arrays[array].1) < room => array,
            _ => {
                arrays.push((shape, 0));
                open.insert(shape, arrays.len() - 1);
                arrays.len() - 1
            }
        };
        let layer = arrays[array].1;
        arrays[array].1 += 1;
        Place {
            array: array as u32,
            layer,
        }
    };
    let places = shapes.iter().map(place).collect();
    (places, arrays)
}

/// A scene's textures.
#[derive(Debug)]
pub(crate) struct Textures {
    places: Vec<Place>,
    arrays: Vec<wgpu::TextureView>,
    /// Of each texture alone.
    alone: Vec<wgpu::TextureView>,
    /// Of all arrays.
    bytes: u64,
}

impl Textures {
    /// Uploads `textures`; levels larger than the device's limit are left out. One that is owned is
    /// freed once it is on the device.
    ///
    /// # Errors
    /// [`Error::Scene`] for a texture whose levels are not those of its size,
    /// [`Error::Limit`] for one whose smallest level is larger than that,
    /// [`Error::NoTexels`] for one without levels.
    pub(crate) fn new(
        gpu: &Gpu,
        textures: Vec<Cow<'_, Texture>>,
        limits: ArrayLimits,
    ) -> Result<Self, Error> {
        let limit = gpu.device.limits().max_texture_dimension_2d;
        let shapes = (textures.iter())
            .map(|t| Shape::of(t, limit, limits.blocks))
            .collect::<Result<Vec<_>, _>>()?;
        let (shapes, firsts): (Vec<_>, Vec<_>) = shapes.into_iter().unzip();
        let (places, arrays) = arrange(&shapes, limits);
        let of_array = |(shape, layers): &(Shape, u32)| shape.bytes() * u64::from(*layers);
        let bytes = arrays.iter().map(of_array).sum();
        let arrays: Vec<_> = arrays.iter().map(|a| create(gpu, *a)).collect();
        let mut uploads = Uploads::new(gpu);
        for ((texture, first), place) in textures.into_iter().zip(&firsts).zip(&places) {
            let shape = arrays[place.array as usize].1;
            for (mip, level) in (0..).zip(*first..texture.levels.len()) {
                let texels = if shape.encoding == texture.encoding {
                    Cow::Borrowed(&texture.levels[level][..])
                } else {
                    texture.decoded_level(level)
                };
                let array = &arrays[place.array as usize].0;
                write(gpu, array, shape, mip, *place, &texels);
                uploads.add(texels.len());
            }
        }
        let arrays: Vec<_> = arrays.into_iter().map(|(view, _)| view).collect();
        Ok(Self {
            alone: (places.iter())
                .map(|place| layer_of(&arrays[place.array as usize], place.layer))
                .collect(),
            arrays,
            places,
            bytes,
        })
    }

    /// Bytes of the texels or blocks of all textures on the device.
    pub(crate) fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Where a texture lies.
    pub(crate) fn place(&self, texture: u32) -> Place {
        self.places[texture as usize]
    }

    /// A view of all layers of an array.
    pub(crate) fn array(&self, array: u32) -> wgpu::TextureView {
        layers_of(&self.arrays[array as usize])
    }

    /// A view of one texture.
    pub(crate) fn alone(&self, texture: u32) -> &wgpu::TextureView {
        &self.alone[texture as usize]
    }
}

fn create(gpu: &Gpu, (shape, layers): (Shape, u32)) -> (wgpu::TextureView, Shape) {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("textures"),
        size: shape.extent(0, layers),
        mip_level_count: shape.levels,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: shape.format(),
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    (texture.create_view(&Default::default()), shape)
}

fn write(gpu: &Gpu, array: &wgpu::TextureView, shape: Shape, level: u32, at: Place, texels: &[u8]) {
    let (side, extent) = (shape.encoding.block_side(), shape.extent(level, 1));
    // Whole blocks, also beyond the border of the last levels.
    let extent = wgpu::Extent3d {
        width: extent.width.next_multiple_of(side),
        height: extent.height.next_multiple_of(side),
        ..extent
    };
    let row_bytes = extent.width / side * shape.encoding.block_bytes();
    gpu.queue.write_texture(
        wgpu::TexelCopyTextureInfo {
            mip_level: level,
            origin: wgpu::Origin3d {
                x: 0,
                y: 0,
                z: at.layer,
            },
            ..array.texture().as_image_copy()
        },
        texels,
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(row_bytes),
            rows_per_image: None,
        },
        extent,
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Frame;
    use crate::testing::{picture, rendered, small};

    #[test]
    fn freed_textures_are_on_the_device() {
        let mut scene = foveal_generate::by_name("alpha").expect("it is generated");
        let camera = scene.cameras[0].clone();
        let mut renderer = rendered(&scene, &camera, &small(64, 48));
        let expected = picture(&renderer);
        assert!(scene.textures.iter().any(|t| t.width > 1));
        pollster::block_on(async {
            let nothing = foveal_scene::Scene::default();
            renderer.set_scene(&nothing).await.expect("it fits");
            renderer.render(&Frame::new(&camera)).await.expect("drawn");
            assert_ne!(renderer.read_picture().await.expect("read"), expected);
            let freed = renderer.set_scene_and_free_textures(&mut scene).await;
            freed.expect("it fits");
            renderer.render(&Frame::new(&camera)).await.expect("drawn");
            assert_eq!(renderer.read_picture().await.expect("read"), expected);
        });
        assert!(scene.textures.iter().all(|t| t.levels.is_empty()));
        assert_eq!(renderer.scene_stats().textures, scene.textures.len() as u64);
        let again = pollster::block_on(renderer.set_scene(&scene));
        let text = again.expect_err("it has no texels").to_string();
        assert!(text.contains("' has no texels"), "{text}");
    }

    fn limited(layers: u32, bytes: u64) -> ArrayLimits {
        ArrayLimits {
            layers,
            bytes,
            blocks: true,
        }
    }

    fn shape(width: u32, color_space: ColorSpace) -> Shape {
        Shape {
            color_space,
            encoding: Encoding::Rgba8,
            width,
            height: 7,
            levels: 3,
        }
    }

    fn of_blocks() -> Texture {
        let levels = [64, 16, 16, 16].map(|bytes| vec![0; bytes]);
        Texture {
            name: "normals".to_owned(),
            width: 8,
            height: 8,
            color_space: ColorSpace::Linear,
            sampler: foveal_scene::Sampler::default(),
            encoding: Encoding::Bc5,
            levels: levels.to_vec(),
        }
    }

    #[test]
    fn levels_that_are_not_of_the_textures_size_are_refused_by_name() {
        type Change = fn(&mut Texture);
        let changes: [(Change, &str); 6] = [
            (
                |t| t.levels[0].truncate(63),
                "63 bytes at level 0, which takes 64",
            ),
            (
                |t| t.levels[3].push(0),
                "17 bytes at level 3, which takes 16",
            ),
            (|t| t.width = 16, "64 bytes at level 0, which takes 128"),
            (|t| t.encoding = Encoding::Rgba8, "level 0, which takes 256"),
            (
                |t| t.levels.resize(40, vec![0; 16]),
                "40 levels, and there are 4 at most",
            ),
            (
                |t| (t.width, t.height) = (0, 0),
                "4 levels, and there are 1 at most",
            ),
        ];
        for (change, says) in changes {
            let mut texture = of_blocks();
            change(&mut texture);
            let error = Shape::of(&texture, 8192, true).expect_err(says);
            assert!(matches!(error, Error::Scene { .. }), "{error}");
            let text = error.to_string();
            assert!(text.contains("'normals'") && text.contains(says), "{text}");
        }
    }

    #[test]
    fn levels_that_a_device_drops_may_leave_no_whole_blocks() {
        let texture = of_blocks();
        for (limit, blocks, encoding) in [
            (8, true, Encoding::Bc5),
            (4, true, Encoding::Bc5),
            (3, true, Encoding::Rgba8),
            (8, false, Encoding::Rgba8),
        ] {
            let (shape, _) = Shape::of(&texture, limit, blocks).expect("it fits");
            assert_eq!(shape.encoding, encoding, "{limit} {blocks}");
        }
    }

    #[test]
    fn textures_of_one_shape_share_arrays_that_hold_no_more_than_they_may() {
        let (a, b) = (shape(5, ColorSpace::Srgb), shape(5, ColorSpace::Linear));
        let c = shape(6, ColorSpace::Srgb);
        let shapes = [a, b, a, c, a, a, b, a];
        for (layers, bytes) in [
            (1, 1 << 20),
            (2, 1 << 20),
            (256, 1 << 20),
            (256, 400),
            (9, 1),
        ] {
            let limits = limited(layers, bytes);
            let (places, arrays) = arrange(&shapes, limits);
            let mut seen = std::collections::BTreeSet::new();
            for (shape, place) in shapes.iter().zip(&places) {
                let (of_array, layers) = arrays[place.array as usize];
                assert_eq!(*shape, of_array);
                assert!(place.layer < layers);
                assert!(seen.insert((place.array, place.layer)), "a layer each");
            }
            for (shape, count) in &arrays {
                assert!(*count <= layers);
                assert!(*count == 1 || u64::from(*count) * shape.bytes() <= bytes);
            }
            let layers_used: u32 = arrays.iter().map(|(_, count)| count).sum();
            assert_eq!(layers_used as usize, shapes.len());
        }
        // 5 x 7, 2 x 3 and 1 x 1 texels of 4 bytes.
        assert_eq!(a.bytes(), 168);
        let arrays_of = |layers, bytes| arrange(&shapes, limited(layers, bytes)).1.len();
        assert_eq!(arrays_of(256, 1 << 20), 3);
        assert_eq!(arrays_of(2, 1 << 20), 5);
        assert_eq!(arrays_of(256, 400), 5);
        assert_eq!(arrays_of(1, 1 << 20), 8);
    }
}
