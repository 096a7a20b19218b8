// Masked Occlusion Culling's calls on foveal-cull, to try it in a program that has them.
//
// For C++11. Include this instead of MaskedOcclusionCulling.h and link foveal_cull_c. What differs:
//
// - RenderTriangles collects; the frame is rasterized by the first test after it. Alternating draws and
//   tests gives right answers, but each first test rasterizes everything that was drawn since ClearBuffer.
// - Meshes are baked when they are seen first, without adjacency, about 0.5 microseconds per triangle, and
//   known again by a hash of their content. SetStaticMeshes(true) knows them by their addresses instead,
//   without hashing: call it again after freeing meshes. Vertices that are given in clip space change in
//   every frame and are baked in every frame: pass model vertices and a matrix. A frame may have up to 32
//   views, each with its ClearBuffer: with more, meshes that one view alone draws may be baked in every frame.
// - Tests that run on the job system that was given to SetJobs need a Finish() before: the first test would
//   wait for workers that wait for the first test.
// - RenderTriangles always returns VISIBLE, which is the safe answer. Clip planes are found without the mask.
// - The picture of SetResolution is sampled at its own pixel centres, as by MOC; the buffer behind it has
//   a quarter of its size per axis, rounded up.
// - A near clip plane of 0 is one of 0.0001.
// - There are no bins (BinTriangles, RenderTrilist, CullingThreadpool) and no MergeBuffer: SetJobs gives the
//   frame to a job system. GetImplementation, GetStatistics and TransformVertices are missing too.
// - Errors hide nothing: a mesh that cannot be baked or placed is not drawn, and where a frame or a test
//   fails the answer is VISIBLE. GetLastStatus says which error was the last.
//
// Tests may run on many threads at once, but not while another thread draws or clears.
//
// The names are those of Intel's Masked Occlusion Culling; nothing of its code is here.
// Licence: MIT or Apache-2.0.
#ifndef FOVEAL_CULL_MOC_SHIM_HPP
#define FOVEAL_CULL_MOC_SHIM_HPP

#include "foveal_cull.h"

#include <algorithm>
#include <atomic>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <mutex>
#include <unordered_map>
#include <vector>

class MaskedOcclusionCulling {
public:
    typedef void *(*pfnAlignedAlloc)(size_t alignment, size_t size);
    typedef void (*pfnAlignedFree)(void *ptr);

    enum Implementation { SSE2 = 0, SSE41 = 1, AVX2 = 2, AVX512 = 3 };
    enum BackfaceWinding { BACKFACE_NONE = 0, BACKFACE_CW = 1, BACKFACE_CCW = 2 };
    enum CullingResult { VISIBLE = 0x0, OCCLUDED = 0x1, VIEW_CULLED = 0x3 };
    enum ClipPlanes {
        CLIP_PLANE_NONE = 0x00,
        CLIP_PLANE_NEAR = 0x01,
        CLIP_PLANE_LEFT = 0x02,
        CLIP_PLANE_RIGHT = 0x04,
        CLIP_PLANE_BOTTOM = 0x08,
        CLIP_PLANE_TOP = 0x10,
        CLIP_PLANE_SIDES = 0x1e,
        CLIP_PLANE_ALL = 0x1f
    };

    struct VertexLayout {
        VertexLayout() : VertexLayout(16, 4, 12) {}
        VertexLayout(int stride, int offset_y, int offset_zw)
            : mStride(stride), mOffsetY(offset_y), mOffsetZ(offset_zw) {}
        int mStride;
        int mOffsetY;
        union {
            int mOffsetZ;
            int mOffsetW;
        };
    };

    /// The instruction set is found at run time; the argument is ignored.
    static MaskedOcclusionCulling *Create(Implementation = AVX512) { return new MaskedOcclusionCulling(); }
    /// The functions are ignored: the library allocates for itself.
    static MaskedOcclusionCulling *Create(Implementation, pfnAlignedAlloc, pfnAlignedFree) { return Create(); }
    static void Destroy(MaskedOcclusionCulling *moc) { delete moc; }

    void SetResolution(unsigned int width, unsigned int height) {
        width_ = width;
        height_ = height;
        foveal_culler_destroy(culler_);
        culler_ = nullptr;
        note(foveal_culler_create_for_picture(width, height, &culler_));
        dirty_ = true;
    }
    void GetResolution(unsigned int &width, unsigned int &height) const {
        width = width_;
        height = height_;
    }
    void SetNearClipPlane(float near_distance) {
        near_ = near_distance;
        dirty_ = true;
    }
    float GetNearClipPlane() const { return near_; }

    /// Begins a frame: forgets what was drawn.
    void ClearBuffer() {
        ++frame_;
        for (auto known = meshes_.begin(); known != meshes_.end();) {
            Known &mesh = known->second;
            mesh.drawn = 0;
            // Clip-space vertices that were there in one frame only do not come back.
            const bool once = mesh.first_frame == mesh.last_frame && !static_meshes_;
            const std::uint64_t kept = !once ? FRAMES_KEPT : mesh.in_clip_space ? 1 : FRAMES_KEPT_ONCE;
            if (frame_ - mesh.last_frame > kept) {
                forget(mesh);
                known = meshes_.erase(known);
            } else {
                ++known;
            }
        }
        dirty_ = true;
    }

    CullingResult RenderTriangles(const float *vertices, const unsigned int *triangles, int count,
                                  const float *clip_from_model = nullptr, BackfaceWinding winding = BACKFACE_CW,
                                  ClipPlanes = CLIP_PLANE_ALL, const VertexLayout &layout = VertexLayout()) {
        double place[12];
        place_of(clip_from_model, place);
        if (count <= 0 || !std::all_of(place, place + 12, [](double v) { return std::isfinite(v); })) {
            return VISIBLE;
        }
        // Faces are turned by what the culler would turn them: placements that mirror.
        const bool turn = mirrors(place) != (winding == BACKFACE_CCW);
        Known *mesh = known(Source{vertices, triangles, count, layout, turn, winding == BACKFACE_NONE});
        if (mesh == nullptr) {
            return VISIBLE;
        }
        mesh->last_frame = frame_;
        mesh->in_clip_space = clip_from_model == nullptr;
        dirty_ = true;
        if (mesh->drawn < mesh->ids.size()) {
            const FovealCullOccluderId id = mesh->ids[mesh->drawn];
            const bool off = mesh->drawn >= mesh->enabled;
            // An occluder that stayed at its old place counts as not drawn: the next frame switches it off.
            if (!note(foveal_cull_occluders_move(occluders_, &id, place, 1)) ||
                (off && !note(foveal_cull_occluders_enable(occluders_, id, 1)))) {
                return VISIBLE;
            }
            mesh->enabled = off ? mesh->drawn + 1 : mesh->enabled;
        } else {
            FovealCullOccluderId id{};
            if (!note(foveal_cull_occluders_add(occluders_, mesh->mesh, place, &id))) {
                return VISIBLE;
            }
            mesh->ids.push_back(id);
            mesh->enabled = mesh->ids.size();
        }
        ++mesh->drawn;
        return VISIBLE;
    }

    /// A rectangle in normalized device coordinates at the clip-space w of its nearest point.
    CullingResult TestRect(float xmin, float ymin, float xmax, float ymax, float wmin) const {
        // Nearer than the near plane nothing is known.
        if (!(wmin > used_near()) || !finish()) {
            return VISIBLE;
        }
        const float box[6] = {xmin * wmin, ymin * wmin, -wmin, xmax * wmin, ymax * wmin, -wmin};
        std::uint8_t result = FOVEAL_CULL_VISIBLE;
        note(foveal_culler_test_boxes(culler_, box, 1, nullptr, &result));
        return of(result);
    }

    /// Tests a box around each triangle that faces the eye: VISIBLE if one of them may be seen.
    CullingResult TestTriangles(const float *vertices, const unsigned int *triangles, int count,
                                const float *clip_from_model = nullptr, BackfaceWinding winding = BACKFACE_CW,
                                ClipPlanes = CLIP_PLANE_ALL, const VertexLayout &layout = VertexLayout()) const {
        if (!finish()) {
            return VISIBLE;
        }
        double place[12];
        place_of(clip_from_model, place);
        const std::size_t most = 128;
        float boxes[most][6];
        std::uint8_t results[most];
        std::size_t boxed = 0;
        bool occluded = false;
        for (int t = 0; t < count; ++t) {
            double corner[3][3];
            for (int k = 0; k < 3; ++k) {
                float point[3];
                read(vertices, triangles[3 * t + k], layout, point);
                const double x = static_cast<double>(point[0]);
                const double y = static_cast<double>(point[1]);
                const double z = static_cast<double>(point[2]);
                for (int axis = 0; axis < 3; ++axis) {
                    corner[k][axis] = place[axis] * x + place[3 + axis] * y + place[6 + axis] * z +
                                      place[9 + axis];
                    // NaN, or beyond what a box can hold.
                    if (!(std::fabs(corner[k][axis]) <= static_cast<double>(FLT_MAX))) {
                        return VISIBLE;
                    }
                }
            }
            if (faces_away(corner, winding)) {
                continue;
            }
            for (int axis = 0; axis < 3; ++axis) {
                // Without std::min and std::max, which windows.h makes macros of.
                double low = corner[0][axis], high = low;
                for (int k = 1; k < 3; ++k) {
                    low = corner[k][axis] < low ? corner[k][axis] : low;
                    high = corner[k][axis] > high ? corner[k][axis] : high;
                }
                // Rounded outwards.
                boxes[boxed][axis] = std::nextafter(static_cast<float>(low), -INFINITY);
                boxes[boxed][axis + 3] = std::nextafter(static_cast<float>(high), INFINITY);
            }
            ++boxed;
            if (boxed == most || t + 1 == count) {
                const CullingResult some = any_of(boxes[0], results, boxed);
                boxed = 0;
                if (some == VISIBLE) {
                    return VISIBLE;
                }
                occluded |= some == OCCLUDED;
            }
        }
        const CullingResult rest = any_of(boxes[0], results, boxed);
        return rest == VISIBLE ? VISIBLE : occluded || rest == OCCLUDED ? OCCLUDED : VIEW_CULLED;
    }

    /// 1 / w per pixel of the picture; -1 where nothing is proven to be covered. Rows count from the bottom
    /// unless `flip_y`.
    void ComputePixelDepthBuffer(float *depth, bool flip_y) const {
        const std::size_t width = (width_ + 3) / 4, height = (height_ + 3) / 4;
        std::vector<float> pixels(width * height, 0.0f);
        if (finish()) {
            note(foveal_culler_read_depth(culler_, pixels.data(), pixels.size()));
        }
        for (std::size_t y = 0; y < height_; ++y) {
            const std::size_t row = flip_y ? y : height_ - 1 - y;
            for (std::size_t x = 0; x < width_; ++x) {
                const float value = pixels[row / 4 * width + x / 4];
                depth[y * width_ + x] = value > 0.0f ? value / used_near() : -1.0f;
            }
        }
    }

    // ---- Not of Masked Occlusion Culling ----

    /// Meshes are known by their addresses: their content must not change. Forgets all meshes and what was
    /// drawn since ClearBuffer. Call it again after freeing meshes, since other meshes may get their memory.
    void SetStaticMeshes(bool are_static) {
        static_meshes_ = are_static;
        for (auto &entry : meshes_) {
            forget(entry.second);
        }
        meshes_.clear();
        dirty_ = true;
    }
    /// The number of baked meshes that are kept.
    std::size_t GetMeshCount() const { return meshes_.size(); }
    /// The job system that frames are rasterized by; null for the calling thread. It is copied.
    void SetJobs(const FovealCullJobs *jobs) {
        has_jobs_ = jobs != nullptr;
        if (has_jobs_) {
            jobs_ = *jobs;
        }
    }
    /// Rasterizes what was drawn since the last test. Call it after the draws and before tests that run on
    /// the job system of SetJobs.
    void Finish() const { finish(); }
    /// The last error, FOVEAL_CULL_OK if there was none.
    FovealCullStatus GetLastStatus() const { return static_cast<FovealCullStatus>(status_.load()); }

    MaskedOcclusionCulling(const MaskedOcclusionCulling &) = delete;
    MaskedOcclusionCulling &operator=(const MaskedOcclusionCulling &) = delete;

private:
    /// Frames after which a mesh is forgotten that was drawn in several frames, or is static.
    static constexpr std::uint64_t FRAMES_KEPT = 120;
    /// The same for other model meshes, which a frame of so many views clears and draws once.
    static constexpr std::uint64_t FRAMES_KEPT_ONCE = 32;

    struct Source {
        const float *vertices;
        const unsigned int *triangles;
        int count;
        VertexLayout layout;
        bool turn;
        bool two_sided;
    };

    struct Known {
        FovealCullMesh *mesh = nullptr;
        std::vector<FovealCullOccluderId> ids;
        std::size_t drawn = 0;
        std::size_t enabled = 0;
        std::uint64_t first_frame = 0;
        std::uint64_t last_frame = 0;
        bool in_clip_space = false;
    };

    struct Key {
        std::uint64_t hash[2];
        bool operator==(const Key &other) const { return hash[0] == other.hash[0] && hash[1] == other.hash[1]; }
    };
    struct HashKey {
        std::size_t operator()(const Key &key) const { return static_cast<std::size_t>(key.hash[0]); }
    };

    /// Two hashes of 64 bits over the same words.
    struct Hash {
        Key key{{0xcbf29ce484222325u, 0x9e3779b97f4a7c15u}};
        void add(std::uint64_t word) {
            key.hash[0] = (key.hash[0] ^ word) * 0x00000100000001b3u;
            key.hash[0] ^= key.hash[0] >> 29;
            key.hash[1] = (key.hash[1] + word) * 0xbf58476d1ce4e5b9u;
            key.hash[1] ^= key.hash[1] >> 31;
        }
    };

    MaskedOcclusionCulling() { note(foveal_cull_occluders_create(&occluders_)); }
    ~MaskedOcclusionCulling() {
        for (auto &known : meshes_) {
            foveal_cull_mesh_destroy(known.second.mesh);
        }
        foveal_cull_occluders_destroy(occluders_);
        foveal_culler_destroy(culler_);
    }

    void forget(const Known &mesh) {
        for (const FovealCullOccluderId id : mesh.ids) {
            note(foveal_cull_occluders_remove(occluders_, id));
        }
        foveal_cull_mesh_destroy(mesh.mesh);
    }

    bool note(FovealCullStatus status) const {
        if (status != FOVEAL_CULL_OK) {
            status_ = status;
        }
        return status == FOVEAL_CULL_OK;
    }

    static CullingResult of(std::uint8_t result) {
        return result == FOVEAL_CULL_OCCLUDED ? OCCLUDED : result == FOVEAL_CULL_OUTSIDE ? VIEW_CULLED : VISIBLE;
    }

    float used_near() const { return near_ > 1e-4f ? near_ : 1e-4f; }

    /// The columns that take model space to (x, y, -w): the space of an eye with tangents of -1 to 1.
    static void place_of(const float *m, double *place) {
        static const float identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0};
        m = m == nullptr ? identity : m;
        for (int column = 0; column < 4; ++column) {
            place[3 * column] = m[4 * column];
            place[3 * column + 1] = m[4 * column + 1];
            place[3 * column + 2] = -static_cast<double>(m[4 * column + 3]);
        }
    }

    static bool mirrors(const double *p) {
        return p[0] * (p[4] * p[8] - p[5] * p[7]) - p[3] * (p[1] * p[8] - p[2] * p[7]) +
                   p[6] * (p[1] * p[5] - p[2] * p[4]) <
               0.0;
    }

    /// Whether a triangle is certainly a back face; `corner` is (x, y, -w).
    static bool faces_away(const double (&c)[3][3], BackfaceWinding winding) {
        const double volume = -(c[0][0] * (c[1][1] * c[2][2] - c[1][2] * c[2][1]) -
                                c[0][1] * (c[1][0] * c[2][2] - c[1][2] * c[2][0]) +
                                c[0][2] * (c[1][0] * c[2][1] - c[1][1] * c[2][0]));
        return winding == BACKFACE_CW ? volume < 0.0 : winding == BACKFACE_CCW && volume > 0.0;
    }

    static void read(const float *vertices, unsigned int index, const VertexLayout &layout, float *point) {
        const char *at = reinterpret_cast<const char *>(vertices) +
                         static_cast<std::ptrdiff_t>(index) * layout.mStride;
        std::memcpy(point, at, sizeof(float));
        std::memcpy(point + 1, at + layout.mOffsetY, sizeof(float));
        std::memcpy(point + 2, at + layout.mOffsetZ, sizeof(float));
    }

    /// By content: the corners of the triangles. Vertices that no index names may lie outside of memory.
    Key key_of(const Source &s) const {
        Hash hash;
        hash.add(static_cast<std::uint64_t>(s.count) << 2 | (s.turn ? 2u : 0u) | (s.two_sided ? 1u : 0u));
        if (static_meshes_) {
            hash.add(reinterpret_cast<std::uintptr_t>(s.vertices));
            hash.add(reinterpret_cast<std::uintptr_t>(s.triangles));
            hash.add(static_cast<std::uint64_t>(s.layout.mStride) << 32 | static_cast<std::uint32_t>(s.layout.mOffsetY));
            hash.add(static_cast<std::uint64_t>(s.layout.mOffsetZ));
            return hash.key;
        }
        for (std::size_t i = 0; i < 3 * static_cast<std::size_t>(s.count); ++i) {
            float point[3];
            std::uint32_t bits[3];
            read(s.vertices, s.triangles[i], s.layout, point);
            std::memcpy(bits, point, sizeof bits);
            hash.add(static_cast<std::uint64_t>(bits[0]) << 32 | bits[1]);
            hash.add(bits[2]);
        }
        return hash.key;
    }

    /// A mesh that was baked before, or is baked now; null if it cannot be.
    Known *known(const Source &s) {
        const Key key = key_of(s);
        const auto found = meshes_.find(key);
        if (found != meshes_.end()) {
            return &found->second;
        }
        std::vector<unsigned int> triangles(s.triangles, s.triangles + 3 * static_cast<std::size_t>(s.count));
        // Only vertices that are named, in the order of their numbers.
        std::vector<unsigned int> named(triangles);
        std::sort(named.begin(), named.end());
        named.erase(std::unique(named.begin(), named.end()), named.end());
        std::vector<float> points(3 * named.size());
        for (std::size_t i = 0; i < named.size(); ++i) {
            read(s.vertices, named[i], s.layout, &points[3 * i]);
        }
        for (unsigned int &index : triangles) {
            index = static_cast<unsigned int>(std::lower_bound(named.begin(), named.end(), index) - named.begin());
        }
        for (std::size_t t = 0; s.turn && t < triangles.size(); t += 3) {
            std::swap(triangles[t + 1], triangles[t + 2]);
        }
        FovealCullMeshSource source{};
        note(foveal_cull_mesh_source_init(&source));
        source.positions = points.data();
        source.position_count = named.size();
        source.indices = triangles.data();
        source.index_count = triangles.size();
        source.two_sided = s.two_sided ? 1 : 0;
        source.adjacency = 0;
        Known mesh;
        mesh.first_frame = frame_;
        if (!note(foveal_cull_mesh_bake(&source, &mesh.mesh))) {
            return nullptr;
        }
        return &meshes_.emplace(key, mesh).first->second;
    }

    /// Rasterizes what was drawn since the last test. False if nothing can be tested.
    bool finish() const {
        if (!dirty_) {
            return ready_;
        }
        const std::lock_guard<std::mutex> lock(mutex_);
        if (!dirty_) {
            return ready_;
        }
        ready_ = culler_ != nullptr && rasterize();
        dirty_ = false;
        return ready_;
    }

    bool rasterize() const {
        for (auto &entry : meshes_) {
            Known &mesh = entry.second;
            while (mesh.enabled > mesh.drawn) {
                note(foveal_cull_occluders_enable(occluders_, mesh.ids[--mesh.enabled], 0));
            }
        }
        FovealCullEye eye{};
        eye.world_from_eye[0] = eye.world_from_eye[4] = eye.world_from_eye[8] = 1.0;
        eye.right = eye.top = 1.0;
        eye.left = eye.bottom = -1.0;
        eye.near_m = static_cast<double>(used_near());
        eye.far_m = std::numeric_limits<double>::infinity();
        FovealCullView view{};
        return note(foveal_cull_view_init(&eye, &view)) &&
               note(foveal_cull_view_for_picture(&view, width_, height_)) &&
               note(foveal_culler_rasterize(culler_, &view, occluders_, nullptr, has_jobs_ ? &jobs_ : nullptr));
    }

    CullingResult any_of(const float *boxes, std::uint8_t *results, std::size_t count) const {
        if (!note(foveal_culler_test_boxes(culler_, boxes, count, nullptr, results))) {
            return VISIBLE;
        }
        CullingResult any = VIEW_CULLED;
        for (std::size_t i = 0; i < count; ++i) {
            const CullingResult one = of(results[i]);
            if (one == VISIBLE) {
                return VISIBLE;
            }
            any = one == OCCLUDED ? OCCLUDED : any;
        }
        return any;
    }

    unsigned int width_ = 0, height_ = 0;
    float near_ = 0.0f;
    std::uint64_t frame_ = 0;
    bool static_meshes_ = false;
    bool has_jobs_ = false;
    FovealCullJobs jobs_{};
    FovealCullOccluders *occluders_ = nullptr;
    FovealCuller *culler_ = nullptr;
    mutable std::unordered_map<Key, Known, HashKey> meshes_;
    mutable std::mutex mutex_;
    mutable std::atomic<bool> dirty_{true};
    mutable bool ready_ = false;
    mutable std::atomic<int> status_{FOVEAL_CULL_OK};
};

#endif
