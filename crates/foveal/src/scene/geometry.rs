//! All meshes in one vertex and one index buffer.

use bytemuck::{Pod, Zeroable};
use foveal_scene::{Scene, Vertex};

use crate::gpu::{Gpu, bind_group, storage_read};
use crate::{Error, Geometry};

const STRIDE: u64 = size_of::<Vertex>() as u64;

/// Slot 0: a vertex; slot 1: its position in the pose of the frame before.
pub(crate) const VERTEX_LAYOUTS: [Option<wgpu::VertexBufferLayout<'static>>; 2] = [
    Some(wgpu::VertexBufferLayout {
        array_stride: STRIDE,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![
            0 => Float32x3, 1 => Float32x3, 2 => Float32x4, 3 => Float32x4, 4 => Unorm8x4
        ],
    }),
    Some(wgpu::VertexBufferLayout {
        array_stride: STRIDE,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![5 => Float32x3],
    }),
];

/// Where a mesh lies in the buffers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct MeshRange {
    pub(crate) first_index: u32,
    pub(crate) index_count: u32,
    pub(crate) base_vertex: i32,
    /// What its indices count from: the base vertex, or 0 where they hold it already.
    pub(crate) index_base: i32,
}

/// Where shaders find an instance's triangles: mirrors `Place` in `shared/attributes.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct PlaceUniform {
    pub(crate) first_index: u32,
    pub(crate) base_vertex: u32,
    pub(crate) material: u32,
    pub(crate) bin: u32,
}

/// The layout of [`SceneGeometry::group`]: bind group 2 of `shared/attributes.wgsl`.
pub(crate) fn geometry_layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    let (vertex, compute) = (wgpu::ShaderStages::VERTEX, wgpu::ShaderStages::COMPUTE);
    // Compute shaders leave the former pose alone: of their eight storage buffers none is to spare.
    let stages = [vertex | compute, vertex, vertex | compute, vertex | compute];
    let entries = std::array::from_fn::<_, 4, _>(|i| wgpu::BindGroupLayoutEntry {
        binding: i as u32,
        visibility: stages[i],
        ty: storage_read(),
        count: None,
    });
    gpu.device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("geometry"),
            entries: &entries,
        })
}

/// The scene's vertices and indices.
#[derive(Debug)]
pub(crate) struct SceneGeometry {
    vertices: wgpu::Buffer,
    /// The pose of the frame before; the same buffer where nothing deforms.
    previous_vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    meshes: Vec<MeshRange>,
    deforms: bool,
    places: wgpu::Buffer,
    /// The layout is [`geometry_layout`]; `None` where shaders cannot read so much.
    group: Option<wgpu::BindGroup>,
    /// Of the larger of the two buffers.
    largest_bytes: u64,
}

impl SceneGeometry {
    /// `bins`: where the pixels of each material are sorted to.
    pub(crate) fn new(gpu: &Gpu, scene: &Scene, bins: &[u32]) -> Result<Self, Error> {
        let vertex_count: usize = scene.meshes.iter().map(|m| m.vertices.len()).sum();
        let index_count: usize = scene.meshes.iter().map(|m| m.indices.len()).sum();
        let limit = gpu.device.limits().max_buffer_size;
        for (what, count, bytes) in [
            ("vertices", vertex_count, STRIDE),
            ("indices", index_count, 4),
        ] {
            if count as u64 * bytes > limit {
                return Err(Error::Limit {
                    what: format!("the scene's number of {what}"),
                    value: count as u64,
                    limit: limit / bytes,
                    hint: String::new(),
                });
            }
        }
        let vertices = buffer(
            gpu,
            "vertices",
            vertex_count as u64 * STRIDE,
            wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::STORAGE,
        );
        let indices = buffer(
            gpu,
            "indices",
            index_count as u64 * 4,
            if gpu.is_reduced() {
                wgpu::BufferUsages::INDEX
            } else {
                wgpu::BufferUsages::INDEX | wgpu::BufferUsages::STORAGE
            },
        );
        let mut meshes = Vec::with_capacity(scene.meshes.len());
        let (mut base_vertex, mut first_index) = (0u64, 0u64);
        for mesh in &scene.meshes {
            gpu.queue.write_buffer(
                &vertices,
                base_vertex * STRIDE,
                bytemuck::cast_slice(&mesh.vertices),
            );
            // WebGL 2 has no base vertex: there it is in the indices.
            let shifted: Vec<u32>;
            let mesh_indices = if gpu.is_reduced() {
                shifted = (mesh.indices.iter())
                    .map(|&index| index + base_vertex as u32)
                    .collect();
                &shifted
            } else {
                &mesh.indices
            };
            gpu.queue.write_buffer(
                &indices,
                first_index * 4,
                bytemuck::cast_slice(mesh_indices),
            );
            meshes.push(MeshRange {
                first_index: first_index as u32,
                index_count: mesh.indices.len() as u32,
                base_vertex: base_vertex as i32,
                index_base: if gpu.is_reduced() {
                    0
                } else {
                    base_vertex as i32
                },
            });
            base_vertex += mesh.vertices.len() as u64;
            first_index += mesh.indices.len() as u64;
        }
        let deforms = scene.meshes.iter().any(|m| m.deforms);
        let previous_vertices = if deforms {
            let previous = buffer(
                gpu,
                "previous vertices",
                vertices.size(),
                wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::STORAGE,
            );
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            encoder.copy_buffer_to_buffer(&vertices, 0, &previous, 0, vertices.size());
            gpu.queue.submit([encoder.finish()]);
            previous
        } else {
            vertices.clone()
        };
        let largest_bytes = vertices.size().max(indices.size());
        let bindable = largest_bytes <= gpu.device.limits().max_storage_buffer_binding_size;
        let places = upload_places(gpu, scene, &meshes, bins);
        let group = bindable.then(|| {
            let buffers = [&vertices, &previous_vertices, &indices, &places];
            let resources = buffers.map(wgpu::Buffer::as_entire_binding);
            bind_group(&gpu.device, "geometry", &geometry_layout(gpu), &resources)
        });
        Ok(Self {
            vertices,
            previous_vertices,
            indices,
            meshes,
            deforms,
            places,
            group,
            largest_bytes,
        })
    }

    /// Checks that passes of this kind can read the geometry.
    ///
    /// # Errors
    /// [`Error::Limit`] where shaders must read it and it is too large for them.
    pub(crate) fn check(&self, gpu: &Gpu, geometry: Geometry) -> Result<(), Error> {
        if geometry == Geometry::Gbuffer || self.group.is_some() {
            return Ok(());
        }
        Err(Error::Limit {
            what: "the scene's largest geometry buffer in bytes".to_owned(),
            value: self.largest_bytes,
            limit: gpu.device.limits().max_storage_buffer_binding_size,
            hint: ": shaders cannot read it, so take the geometry gbuffer".to_owned(),
        })
    }

    /// Bind group 2 of `shared/attributes.wgsl`; `None` for a scene that failed
    /// [`SceneGeometry::check`].
    pub(crate) fn group(&self) -> Option<&wgpu::BindGroup> {
        self.group.as_ref()
    }

    /// A [`PlaceUniform`] per instance.
    pub(crate) fn places(&self) -> &wgpu::Buffer {
        &self.places
    }

    /// Whether any mesh changes its shape with the pose.
    pub(crate) fn deforms(&self) -> bool {
        self.deforms
    }

    /// Uploads the deformed meshes; the vertices so far become the previous ones.
    pub(crate) fn update_pose(&mut self, gpu: &Gpu, scene: &Scene) {
        if !self.deforms {
            return;
        }
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(
            &self.vertices,
            0,
            &self.previous_vertices,
            0,
            self.vertices.size(),
        );
        gpu.queue.submit([encoder.finish()]);
        for (mesh, range) in scene.meshes.iter().zip(&self.meshes) {
            if mesh.deforms {
                let offset = range.base_vertex as u64 * STRIDE;
                gpu.queue.write_buffer(
                    &self.vertices,
                    offset,
                    bytemuck::cast_slice(&mesh.vertices),
                );
            }
        }
    }

    pub(crate) fn mesh(&self, mesh: u32) -> MeshRange {
        self.meshes[mesh as usize]
    }

    /// Binds the buffers to a pass.
    pub(crate) fn bind(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_vertex_buffer(1, self.previous_vertices.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
    }
}

fn upload_places(gpu: &Gpu, scene: &Scene, meshes: &[MeshRange], bins: &[u32]) -> wgpu::Buffer {
    let place = |instance: &foveal_scene::Instance| {
        let mesh = meshes[instance.mesh as usize];
        PlaceUniform {
            first_index: mesh.first_index,
            base_vertex: mesh.base_vertex as u32,
            material: instance.material,
            bin: bins[instance.material as usize],
        }
    };
    let places: Vec<_> = scene.instances.iter().map(place).collect();
    let bytes: &[u8] = bytemuck::cast_slice(&places);
    let usage = wgpu::BufferUsages::STORAGE;
    let buffer = buffer(gpu, "places of instances", bytes.len() as u64, usage);
    gpu.queue.write_buffer(&buffer, 0, bytes);
    buffer
}

fn buffer(gpu: &Gpu, label: &str, bytes: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        // An empty buffer cannot be bound.
        size: bytes.max(STRIDE),
        usage: usage | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    })
}
