//! All meshes in one vertex and one index buffer.

use bytemuck::{Pod, Zeroable};
use foveal_scene::{Mesh, Scene, Vertex};

use super::provoking::provoking_indices;
use super::strokes;
use super::uploads::Uploads;
use crate::gpu::{Gpu, Table, bind_group};
use crate::{Error, Geometry};

const STRIDE: u64 = size_of::<Vertex>() as u64;

/// Slot 0: a vertex; slot 1: its position in the pose of the frame before.
pub(crate) const VERTEX_LAYOUTS: [Option<wgpu::VertexBufferLayout<'static>>; 2] = [
    Some(wgpu::VertexBufferLayout {
        array_stride: STRIDE,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![
            0 => Float32x3, 1 => Float32x3, 2 => Float32x4, 3 => Float32x4, 4 => Unorm16x4
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
    /// Of its triangles.
    pub(crate) first_index: u32,
    pub(crate) index_count: u32,
    pub(crate) base_vertex: i32,
    /// What its indices count from: the base vertex, or 0 where they hold it already.
    pub(crate) index_base: i32,
    /// Of its triangles among the provoking indices.
    first_provoking: u32,
    /// Of the quads of its points and lines, which follow its triangles.
    pub(crate) stroke_index_count: u32,
    /// Points and lines have normals.
    pub(crate) lights_strokes: bool,
    first_stroke_vertex: u32,
    /// Poses may change its vertices.
    deforms: bool,
}

impl MeshRange {
    /// Indices of its triangles, or of its points and lines.
    pub(crate) fn indices(&self, strokes: bool) -> std::ops::Range<u32> {
        let between = self.first_index + self.index_count;
        if strokes {
            between..between + self.stroke_index_count
        } else {
            self.first_index..between
        }
    }

    /// What keeps a mesh from being the one that lies here in another pose.
    pub(super) fn differs_from(&self, mesh: &Mesh) -> Option<&'static str> {
        let vertices = u64::from(self.first_stroke_vertex) - self.base_vertex as u64;
        let indices = [self.index_count, self.stroke_index_count].map(u64::from);
        if vertex_counts(mesh)[0] != vertices || index_counts(mesh) != indices {
            Some("has another number of vertices or indices")
        } else if mesh.deforms && !self.deforms {
            Some("deforms, which it did not")
        } else {
            None
        }
    }

    /// Provoking indices of its triangles.
    pub(crate) fn provoking_indices(&self) -> std::ops::Range<u32> {
        self.first_provoking..self.first_provoking + self.index_count
    }
}

/// Quads that are made and written to the device at a time: 4 MiB of vertices.
const QUADS_AT_A_TIME: usize = 1 << 14;

/// Indices that are written at a time: 1 MiB.
const INDICES_AT_A_TIME: usize = 1 << 18;

/// Vertices that a mesh takes on the device: those of its triangles, and its quads.
fn vertex_counts(mesh: &Mesh) -> [u64; 2] {
    let of_triangles = if mesh.triangle_count() == 0 {
        0
    } else {
        mesh.vertices.len()
    };
    let of_quads = mesh.stroke_count() * strokes::CORNERS;
    [of_triangles, of_quads].map(|count| count as u64)
}

fn index_counts(mesh: &Mesh) -> [u64; 2] {
    let of_quads = mesh.stroke_count() * strokes::INDICES.len();
    [3 * mesh.triangle_count(), of_quads].map(|count| count as u64)
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
        ty: Table::binding_type(gpu),
        count: None,
    });
    gpu.bind_group_layout("geometry", &entries)
}

/// The scene's vertices and indices.
#[derive(Debug)]
pub(crate) struct SceneGeometry {
    vertices: wgpu::Buffer,
    /// The pose of the frame before; the same buffer where nothing deforms.
    previous_vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    /// Those of triangles by which a vertex knows its triangle; `None` where the device numbers
    /// triangles.
    provoking: Option<wgpu::Buffer>,
    pub(super) meshes: Vec<MeshRange>,
    deforms: bool,
    places: Table,
    /// `None` until passes read it.
    readable: Option<Readable>,
}

/// Vertices and indices as shaders read them.
#[derive(Debug)]
pub(crate) struct Readable {
    vertices: Table,
    previous_vertices: Table,
    /// The layout is [`geometry_layout`].
    group: wgpu::BindGroup,
}

impl SceneGeometry {
    /// `bins`: where the pixels of each material are sorted to.
    pub(crate) fn new(gpu: &Gpu, scene: &Scene, bins: &[u32]) -> Result<Self, Error> {
        let sum = |counts: fn(&Mesh) -> [u64; 2]| scene.meshes.iter().flat_map(counts).sum();
        let (vertex_count, index_count): (u64, u64) = (sum(vertex_counts), sum(index_counts));
        let has_strokes = scene.meshes.iter().any(|mesh| mesh.stroke_count() > 0);
        let limit = gpu.device.limits().max_buffer_size;
        for (what, count, bytes) in [
            ("vertices", vertex_count, STRIDE),
            ("indices", index_count, 4),
        ] {
            if count.saturating_mul(bytes) > limit {
                let hint = if has_strokes {
                    ": each point and line takes four vertices and six indices".to_owned()
                } else {
                    String::new()
                };
                return Err(Error::Limit {
                    what: format!("the scene's number of {what}"),
                    value: count,
                    limit: limit / bytes,
                    hint,
                });
            }
        }
        let vertices = buffer(
            gpu,
            "vertices",
            vertex_count * STRIDE,
            wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::STORAGE,
        );
        let indices = buffer(
            gpu,
            "indices",
            index_count * 4,
            if gpu.is_reduced() {
                wgpu::BufferUsages::INDEX
            } else {
                wgpu::BufferUsages::INDEX | wgpu::BufferUsages::STORAGE
            },
        );
        let provoking = (!gpu.is_reduced() && !gpu.numbers_triangles()).then(|| {
            let count: u64 = (scene.meshes.iter()).map(|m| index_counts(m)[0]).sum();
            let usage = wgpu::BufferUsages::INDEX;
            buffer(gpu, "provoking indices", count * 4, usage)
        });
        let mut first_provoking = 0u64;
        let mut uploads = Uploads::new(gpu);
        let mut meshes = Vec::with_capacity(scene.meshes.len());
        let (mut base_vertex, mut first_index) = (0u64, 0u64);
        for mesh in &scene.meshes {
            let [vertices_of_triangles, vertices_of_quads] = vertex_counts(mesh);
            let index_base = if gpu.is_reduced() {
                0
            } else {
                base_vertex as i32
            };
            let range = MeshRange {
                first_index: first_index as u32,
                index_count: index_counts(mesh)[0] as u32,
                base_vertex: base_vertex as i32,
                index_base,
                first_provoking: first_provoking as u32,
                stroke_index_count: index_counts(mesh)[1] as u32,
                lights_strokes: mesh.lights_strokes(),
                first_stroke_vertex: (base_vertex + vertices_of_triangles) as u32,
                deforms: mesh.deforms,
            };
            write_vertices(&mut uploads, &vertices, mesh, range);
            let corners = &mesh.indices[..range.index_count as usize];
            if let Some(provoking) = &provoking {
                let vertices = (base_vertex as u32, mesh.vertices.len());
                let numbers = provoking_indices(corners, range.first_index / 3, vertices);
                in_pieces(numbers, INDICES_AT_A_TIME, |some| {
                    uploads.write(provoking, first_provoking * 4, bytemuck::cast_slice(some));
                    first_provoking += some.len() as u64;
                });
            }
            let mut write = |some: &[u32]| {
                uploads.write(&indices, first_index * 4, bytemuck::cast_slice(some));
                first_index += some.len() as u64;
            };
            if gpu.is_reduced() {
                // WebGL 2 has no base vertex: there it is in the indices.
                let shifted = corners.iter().map(|i| i.wrapping_add(base_vertex as u32));
                in_pieces(shifted, INDICES_AT_A_TIME, &mut write);
            } else {
                write(corners);
            }
            let first = range.first_stroke_vertex - index_base as u32;
            let quads = (0..mesh.stroke_count() as u32)
                .flat_map(|i| strokes::INDICES.map(|corner| first + 4 * i + corner));
            in_pieces(quads, INDICES_AT_A_TIME, &mut write);
            base_vertex += vertices_of_triangles + vertices_of_quads;
            meshes.push(range);
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
        let places = upload_places(gpu, scene, &meshes, bins);
        Ok(Self {
            vertices,
            previous_vertices,
            indices,
            provoking,
            meshes,
            deforms,
            places,
            readable: None,
        })
    }

    /// What shaders read of the geometry, where passes of this kind do and it is not there yet.
    ///
    /// # Errors
    /// [`Error::Limit`] where it is too large for them.
    pub(crate) fn readable(
        &self,
        gpu: &Gpu,
        geometry: Geometry,
    ) -> Result<Option<Readable>, Error> {
        if geometry == Geometry::Gbuffer || self.readable.is_some() {
            return Ok(None);
        }
        let largest_bytes = self.vertices.size().max(self.indices.size());
        let limit = Table::limit(gpu);
        if largest_bytes > limit {
            return Err(Error::Limit {
                what: "the scene's largest geometry buffer in bytes".to_owned(),
                value: largest_bytes,
                limit,
                hint: ": shaders cannot read it, so take the geometry gbuffer".to_owned(),
            });
        }
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut table = |label, buffer| {
            let table = Table::of_buffer(gpu, label, buffer);
            table.copy(&mut encoder, buffer);
            table
        };
        let vertices = table("vertices that shaders read", &self.vertices);
        let indices = table("indices that shaders read", &self.indices);
        let previous_vertices = if self.deforms {
            table(
                "previous vertices that shaders read",
                &self.previous_vertices,
            )
        } else {
            vertices.clone()
        };
        gpu.queue.submit([encoder.finish()]);
        let tables = [&vertices, &previous_vertices, &indices, &self.places];
        let resources = tables.map(Table::resource);
        let group = bind_group(&gpu.device, "geometry", &geometry_layout(gpu), &resources);
        Ok(Some(Readable {
            vertices,
            previous_vertices,
            group,
        }))
    }

    /// Keeps what [`SceneGeometry::readable`] found.
    pub(crate) fn take_readable(&mut self, readable: Option<Readable>) {
        if readable.is_some() {
            self.readable = readable;
        }
    }

    /// Bind group 2 of `shared/attributes.wgsl`; `None` until passes read it.
    pub(crate) fn group(&self) -> Option<&wgpu::BindGroup> {
        self.readable.as_ref().map(|readable| &readable.group)
    }

    /// A [`PlaceUniform`] per instance.
    pub(crate) fn places(&self) -> &Table {
        &self.places
    }

    /// Whether any mesh changes its shape with the pose.
    pub(crate) fn deforms(&self) -> bool {
        self.deforms
    }

    /// The vertices become the previous ones.
    fn keep_vertices(&self, gpu: &Gpu) {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(
            &self.vertices,
            0,
            &self.previous_vertices,
            0,
            self.vertices.size(),
        );
        gpu.queue.submit([encoder.finish()]);
    }

    /// No mesh changes its shape any more.
    pub(crate) fn end_motion(&mut self, gpu: &Gpu) {
        if !self.deforms {
            return;
        }
        self.keep_vertices(gpu);
        if let Some(readable) = &self.readable {
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            let previous = (&readable.previous_vertices, &self.previous_vertices);
            previous.0.copy(&mut encoder, previous.1);
            gpu.queue.submit([encoder.finish()]);
        }
    }

    /// Uploads the deformed meshes; the vertices so far become the previous ones.
    pub(crate) fn update_pose(&mut self, gpu: &Gpu, scene: &Scene) {
        if !self.deforms {
            return;
        }
        self.keep_vertices(gpu);
        let mut uploads = Uploads::in_passing(gpu);
        for (mesh, range) in scene.meshes.iter().zip(&self.meshes) {
            if mesh.deforms {
                write_vertices(&mut uploads, &self.vertices, mesh, *range);
            }
        }
        if let Some(readable) = &self.readable {
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            let now = (&readable.vertices, &self.vertices);
            let previous = (&readable.previous_vertices, &self.previous_vertices);
            for (table, buffer) in [now, previous] {
                table.copy(&mut encoder, buffer);
            }
            gpu.queue.submit([encoder.finish()]);
        }
    }

    pub(crate) fn mesh(&self, mesh: u32) -> MeshRange {
        self.meshes[mesh as usize]
    }

    /// Binds to a pass whose shader fetches vertices what tells it which.
    pub(crate) fn bind_provoking(&self, pass: &mut wgpu::RenderPass<'_>) {
        if let Some(provoking) = &self.provoking {
            pass.set_index_buffer(provoking.slice(..), wgpu::IndexFormat::Uint32);
        }
    }

    /// Binds the buffers to a pass.
    pub(crate) fn bind(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_vertex_buffer(1, self.previous_vertices.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
    }
}

/// Uploads the vertices of triangles, and the quads.
fn write_vertices(uploads: &mut Uploads<'_>, to: &wgpu::Buffer, mesh: &Mesh, range: MeshRange) {
    if range.index_count > 0 {
        let at = range.base_vertex as u64 * STRIDE;
        uploads.write(to, at, bytemuck::cast_slice(&mesh.vertices));
    }
    let mut at = u64::from(range.first_stroke_vertex) * STRIDE;
    in_pieces(strokes::quads(mesh), QUADS_AT_A_TIME, |quads| {
        let bytes = bytemuck::cast_slice(quads.as_flattened());
        uploads.write(to, at, bytes);
        at += bytes.len() as u64;
    });
}

/// Calls `take` with all items, so many at a time.
fn in_pieces<T>(items: impl Iterator<Item = T>, at_a_time: usize, mut take: impl FnMut(&[T])) {
    let mut items = items;
    let mut some = Vec::new();
    loop {
        some.extend(items.by_ref().take(at_a_time));
        if some.is_empty() {
            return;
        }
        take(&some);
        some.clear();
    }
}

fn upload_places(gpu: &Gpu, scene: &Scene, meshes: &[MeshRange], bins: &[u32]) -> Table {
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
    let mut table = Table::new(gpu, "places of instances");
    table.write(gpu, bytemuck::cast_slice(&places));
    table
}

fn buffer(gpu: &Gpu, label: &str, bytes: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        // An empty buffer cannot be bound, and a table is read by fours of words.
        size: bytes.max(STRIDE).next_multiple_of(STRIDE),
        usage: usage | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    })
}
