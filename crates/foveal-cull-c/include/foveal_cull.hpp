// foveal-cull for C++17: objects that free themselves, and errors as exceptions.
//
// foveal_cull.h says what the functions do. Without exceptions (-fno-exceptions) an error calls
// FOVEAL_CULL_FAIL(status, text), which aborts unless it is defined before this header is included. It
// must not return: what follows it has no object to work on.
//
// Licence: MIT or Apache-2.0.
#ifndef FOVEAL_CULL_HPP
#define FOVEAL_CULL_HPP

#include "foveal_cull.h"

#include <array>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace foveal {
namespace cull {

/// A call that failed.
class Error : public std::runtime_error {
public:
    Error(FovealCullStatus status, const std::string &text) : std::runtime_error(text), status_(status) {}
    FovealCullStatus status() const noexcept { return status_; }

private:
    FovealCullStatus status_;
};

#ifndef FOVEAL_CULL_FAIL
#if defined(__cpp_exceptions) || defined(_CPPUNWIND)
#define FOVEAL_CULL_FAIL(status, text) throw ::foveal::cull::Error((status), (text))
#else
#define FOVEAL_CULL_FAIL(status, text) std::abort()
#endif
#endif

/// Throws an Error unless the status is FOVEAL_CULL_OK.
inline void expect_ok(FovealCullStatus status) {
    if (status == FOVEAL_CULL_OK) {
        return;
    }
    std::string text(foveal_cull_last_error(nullptr, 0), '\0');
    foveal_cull_last_error(&text[0], text.size());
    text.resize(text.size() - 1);
    FOVEAL_CULL_FAIL(status, text);
}

using OccluderId = FovealCullOccluderId;
using OccludeeId = FovealCullOccludeeId;
using Eye = FovealCullEye;
using Options = FovealCullFrameOptions;
using Point = std::array<double, 3>;
/// The columns x axis, y axis, z axis and translation.
using Affine = std::array<double, 12>;

/// A box in metres, relative to an origin.
struct Box {
    float min[3];
    float max[3];
};
static_assert(sizeof(Box) == 6 * sizeof(float), "boxes are six floats in a row");

/// The result for one box. The bytes of the C interface.
enum class Visibility : std::uint8_t {
    visible = FOVEAL_CULL_VISIBLE,
    outside = FOVEAL_CULL_OUTSIDE,
    too_small = FOVEAL_CULL_SMALL,
    occluded = FOVEAL_CULL_OCCLUDED,
};

/// The affine part of a column-major 4x4 matrix.
template <class Number> Affine affine(const Number *column_major) {
    Affine columns{};
    for (std::size_t i = 0; i < 12; ++i) {
        columns[i] = column_major[i / 3 * 4 + i % 3];
    }
    return columns;
}

/// The eye of a column-major matrix from the world to clip space.
inline Eye eye_from_matrix(const double *clip_from_world, FovealCullDepth depth) {
    Eye eye{};
    expect_ok(foveal_cull_eye_from_matrix(clip_from_world, depth, &eye));
    return eye;
}

/// The same with floats.
inline Eye eye_from_matrix(const float *clip_from_world, FovealCullDepth depth) {
    Eye eye{};
    expect_ok(foveal_cull_eye_from_matrix_f32(clip_from_world, depth, &eye));
    return eye;
}

/// A symmetric perspective eye without a far plane. The angle is in radians.
inline Eye look_at(const Point &position, const Point &target, const Point &up, double fov_y_rad, double aspect,
                   double near_m) {
    Eye eye{};
    expect_ok(foveal_cull_eye_look_at(position.data(), target.data(), up.data(), fov_y_rad, aspect, near_m, &eye));
    return eye;
}

/// The camera view of a frame: one eye or two, and how far they may move while the results hold.
class View {
public:
    View(const Eye &eye, double validity_radius_m = 0.0) {
        expect_ok(foveal_cull_view_init(&eye, &view_));
        view_.validity_radius_m = validity_radius_m;
    }
    View(const Eye &left, const Eye &right, double validity_radius_m = 0.0) : View(left, validity_radius_m) {
        view_.eye_count = 2;
        view_.eyes[1] = right;
    }
    /// The view of a picture of this size, for Culler::for_picture: widened to whole pixels of the buffer.
    View for_picture(std::uint32_t width_px, std::uint32_t height_px) const {
        View wide = *this;
        expect_ok(foveal_cull_view_for_picture(&wide.view_, width_px, height_px));
        return wide;
    }
    const FovealCullView *get() const noexcept { return &view_; }

private:
    FovealCullView view_{};
};

/// Options with the defaults.
inline Options default_options() {
    Options options{};
    expect_ok(foveal_cull_frame_options_init(&options));
    return options;
}

namespace detail {
template <class T, void (*destroy)(T *)> struct Destroy {
    void operator()(T *object) const noexcept { destroy(object); }
};
template <class T, void (*destroy)(T *)> using Handle = std::unique_ptr<T, Destroy<T, destroy>>;
} // namespace detail

/// How a mesh is baked. FovealCullMeshSource says more about each.
struct MeshOptions {
    /// Triangles occlude from behind too.
    bool two_sided = false;
    /// What results for two eyes or a radius need is baked.
    bool adjacency = true;
    /// Occluders of the mesh can be given other positions.
    bool deformable = false;
    /// Boxes inside a closed mesh take its place where they are the better occluder.
    bool inner_shape = false;
};

/// A baked mesh.
class Mesh {
public:
    /// Bakes triangles: three floats per position, `stride` bytes apart.
    template <class Index>
    Mesh(const float *positions, std::size_t position_count, std::size_t stride, const Index *indices,
         std::size_t index_count, const MeshOptions &options = {}) {
        static_assert(sizeof(Index) == 2 || sizeof(Index) == 4, "indices have 16 or 32 bits");
        FovealCullMeshSource source{};
        expect_ok(foveal_cull_mesh_source_init(&source));
        source.positions = positions;
        source.position_count = position_count;
        source.position_stride = stride;
        source.indices = indices;
        source.index_count = index_count;
        source.index_bytes = sizeof(Index);
        source.two_sided = options.two_sided ? 1 : 0;
        source.adjacency = options.adjacency ? 1 : 0;
        source.deformable = options.deformable ? 1 : 0;
        source.inner_shape = options.inner_shape ? 1 : 0;
        FovealCullMesh *mesh = nullptr;
        expect_ok(foveal_cull_mesh_bake(&source, &mesh));
        mesh_.reset(mesh);
    }
    /// A box whose faces look outwards.
    static Mesh box(const Box &bounds) {
        FovealCullMesh *mesh = nullptr;
        expect_ok(foveal_cull_mesh_from_box(bounds.min, bounds.max, &mesh));
        return Mesh(mesh);
    }
    /// A terrain of rows of heights, seen from above; every `step`th sample is kept.
    static Mesh terrain(const float *heights, std::size_t columns, std::size_t rows, float spacing_x,
                        float spacing_z, std::size_t step) {
        FovealCullMesh *mesh = nullptr;
        expect_ok(foveal_cull_mesh_from_heights(heights, columns, rows, spacing_x, spacing_z, step, &mesh));
        return Mesh(mesh);
    }
    /// A mesh that was written by to_bytes.
    static Mesh from_bytes(const std::vector<std::uint8_t> &bytes) {
        FovealCullMesh *mesh = nullptr;
        expect_ok(foveal_cull_mesh_from_bytes(bytes.data(), bytes.size(), &mesh));
        return Mesh(mesh);
    }
    /// The mesh as bytes, for a file.
    std::vector<std::uint8_t> to_bytes() const {
        std::vector<std::uint8_t> bytes(foveal_cull_mesh_to_bytes(get(), nullptr, 0));
        if (bytes.empty() || foveal_cull_mesh_to_bytes(get(), bytes.data(), bytes.size()) != bytes.size()) {
            FOVEAL_CULL_FAIL(get() == nullptr ? FOVEAL_CULL_NULL_POINTER : FOVEAL_CULL_INTERNAL,
                             "the bytes of a mesh could not be written");
        }
        return bytes;
    }
    std::size_t triangle_count() const noexcept { return foveal_cull_mesh_triangle_count(mesh_.get()); }
    const FovealCullMesh *get() const noexcept { return mesh_.get(); }

private:
    explicit Mesh(FovealCullMesh *mesh) : mesh_(mesh) {}
    detail::Handle<FovealCullMesh, foveal_cull_mesh_destroy> mesh_;
};

/// A set of occluders.
class Occluders {
public:
    Occluders() {
        FovealCullOccluders *set = nullptr;
        expect_ok(foveal_cull_occluders_create(&set));
        set_.reset(set);
    }
    OccluderId add(const Mesh &mesh) { return add(mesh, nullptr); }
    OccluderId add(const Mesh &mesh, const Affine &world_from_mesh) { return add(mesh, world_from_mesh.data()); }
    void move(OccluderId id, const Affine &world_from_mesh) {
        expect_ok(foveal_cull_occluders_move(set_.get(), &id, world_from_mesh.data(), 1));
    }
    /// After an error none has moved.
    void move_all(const std::vector<OccluderId> &ids, const std::vector<Affine> &world_from_mesh) {
        if (ids.size() != world_from_mesh.size()) {
            FOVEAL_CULL_FAIL(FOVEAL_CULL_WRONG_LENGTH, "as many transforms as ids are needed");
        }
        const double *numbers = ids.empty() ? nullptr : world_from_mesh[0].data();
        expect_ok(foveal_cull_occluders_move(set_.get(), ids.data(), numbers, ids.size()));
    }
    /// Gives an occluder of a deformable mesh other positions, `stride` bytes apart.
    void deform(OccluderId id, const float *positions, std::size_t count, std::size_t stride) {
        expect_ok(foveal_cull_occluders_deform(set_.get(), id, positions, count, stride));
    }
    void enable(OccluderId id, bool enabled) {
        expect_ok(foveal_cull_occluders_enable(set_.get(), id, enabled ? 1 : 0));
    }
    void remove(OccluderId id) { expect_ok(foveal_cull_occluders_remove(set_.get(), id)); }
    std::size_t count() const {
        std::size_t count = 0;
        expect_ok(foveal_cull_occluders_count(set_.get(), &count));
        return count;
    }
    const FovealCullOccluders *get() const noexcept { return set_.get(); }

private:
    OccluderId add(const Mesh &mesh, const double *world_from_mesh) {
        OccluderId id{};
        expect_ok(foveal_cull_occluders_add(set_.get(), mesh.get(), world_from_mesh, &id));
        return id;
    }
    detail::Handle<FovealCullOccluders, foveal_cull_occluders_destroy> set_;
};
static_assert(sizeof(Affine) == 12 * sizeof(double), "transforms are twelve doubles in a row");

/// A hierarchy over boxes that are tested in many frames.
class Tree {
public:
    explicit Tree(const std::vector<Box> &boxes, const Point &origin = {}) : count_(boxes.size()) {
        FovealCullTree *tree = nullptr;
        expect_ok(foveal_cull_tree_build(numbers(boxes), boxes.size(), origin.data(), &tree));
        tree_.reset(tree);
    }
    void refit(const std::vector<Box> &boxes) {
        expect_ok(foveal_cull_tree_refit(tree_.get(), numbers(boxes), boxes.size()));
    }
    std::size_t size() const noexcept { return count_; }
    const FovealCullTree *get() const noexcept { return tree_.get(); }

private:
    static const float *numbers(const std::vector<Box> &boxes) { return boxes.empty() ? nullptr : boxes[0].min; }
    std::size_t count_;
    detail::Handle<FovealCullTree, foveal_cull_tree_destroy> tree_;
};

/// The hierarchy of a set of occludees, built again: snapshot it, build it on any thread, adopt it. It may
/// only be destroyed, moved or assigned to when `build` has returned on the thread that calls it: that it is
/// built, or adopted, is not enough.
class Rebuild {
public:
    /// Builds the hierarchy.
    void build() { expect_ok(foveal_cull_rebuild_build(rebuild_.get())); }
    /// Whether it is built, adopted or not. May be asked while another thread builds it. Building that failed
    /// is an error.
    bool built() const {
        std::uint32_t built = 0;
        expect_ok(foveal_cull_rebuild_is_built(rebuild_.get(), &built));
        return built != 0;
    }

private:
    friend class Occludees;
    explicit Rebuild(FovealCullRebuild *rebuild) : rebuild_(rebuild) {}
    detail::Handle<FovealCullRebuild, foveal_cull_rebuild_destroy> rebuild_;
};

/// Occludees that come, move and go. In each frame: change what has changed, refit, then Culler::test.
class Occludees {
public:
    explicit Occludees(const Point &origin = {}) {
        FovealCullOccludees *set = nullptr;
        expect_ok(foveal_cull_occludees_create(origin.data(), &set));
        set_.reset(set);
    }
    OccludeeId insert(const Box &bounds) {
        OccludeeId id{};
        expect_ok(foveal_cull_occludees_insert(set_.get(), bounds.min, 1, &id));
        return id;
    }
    /// The ids in the order of the boxes. After an error none was inserted.
    std::vector<OccludeeId> insert_all(const std::vector<Box> &boxes) {
        std::vector<OccludeeId> ids(boxes.size());
        expect_ok(foveal_cull_occludees_insert(set_.get(), numbers(boxes), boxes.size(), ids.data()));
        return ids;
    }
    /// Moves or resizes an occludee.
    void move(OccludeeId id, const Box &bounds) {
        expect_ok(foveal_cull_occludees_move(set_.get(), &id, bounds.min, 1));
    }
    /// After an error none has moved.
    void move_all(const std::vector<OccludeeId> &ids, const std::vector<Box> &boxes) {
        if (ids.size() != boxes.size()) {
            FOVEAL_CULL_FAIL(FOVEAL_CULL_WRONG_LENGTH, "as many boxes as ids are needed");
        }
        expect_ok(foveal_cull_occludees_move(set_.get(), ids.data(), numbers(boxes), ids.size()));
    }
    void remove(OccludeeId id) { expect_ok(foveal_cull_occludees_remove(set_.get(), &id, 1)); }
    /// After an error none was removed.
    void remove_all(const std::vector<OccludeeId> &ids) {
        expect_ok(foveal_cull_occludees_remove(set_.get(), ids.data(), ids.size()));
    }
    bool contains(OccludeeId id) const {
        std::uint32_t contains = 0;
        expect_ok(foveal_cull_occludees_contains(set_.get(), id, &contains));
        return contains != 0;
    }
    Box bounds(OccludeeId id) const {
        Box bounds{};
        float both[6] = {};
        expect_ok(foveal_cull_occludees_bounds(set_.get(), id, both));
        for (std::size_t i = 0; i < 3; ++i) {
            bounds.min[i] = both[i];
            bounds.max[i] = both[i + 3];
        }
        return bounds;
    }
    /// The place of an occludee's result in the results of a test. It never changes.
    std::uint32_t index(OccludeeId id) const {
        std::uint32_t index = 0;
        expect_ok(foveal_cull_occludees_indices(set_.get(), &id, 1, &index));
        return index;
    }
    std::vector<std::uint32_t> indices(const std::vector<OccludeeId> &ids) const {
        std::vector<std::uint32_t> indices(ids.size());
        expect_ok(foveal_cull_occludees_indices(set_.get(), ids.data(), ids.size(), indices.data()));
        return indices;
    }
    std::size_t count() const {
        std::size_t count = 0;
        expect_ok(foveal_cull_occludees_count(set_.get(), &count));
        return count;
    }
    /// The number of results of a test.
    std::size_t result_count() const {
        std::size_t count = 0;
        expect_ok(foveal_cull_occludees_result_count(set_.get(), &count));
        return count;
    }
    /// Fits the hierarchy to what has moved: once before the tests of a frame.
    void refit() { expect_ok(foveal_cull_occludees_refit(set_.get())); }
    bool wants_rebuild() const {
        std::uint32_t wants = 0;
        expect_ok(foveal_cull_occludees_wants_rebuild(set_.get(), &wants));
        return wants != 0;
    }
    /// Builds the hierarchy again on this thread.
    void rebuild() { expect_ok(foveal_cull_occludees_rebuild(set_.get())); }
    /// The occludees of now, to be built on another thread and adopted afterwards.
    Rebuild snapshot() const {
        FovealCullRebuild *rebuild = nullptr;
        expect_ok(foveal_cull_occludees_snapshot(set_.get(), &rebuild));
        return Rebuild(rebuild);
    }
    /// Takes over a hierarchy that was built from a snapshot of this set. `rebuild` stays, empty, until the
    /// caller destroys it: the thread that built it may not have returned yet. After an error it has the
    /// hierarchy still.
    void adopt(const Rebuild &rebuild) {
        expect_ok(foveal_cull_occludees_adopt(set_.get(), rebuild.rebuild_.get()));
    }
    const FovealCullOccludees *get() const noexcept { return set_.get(); }

private:
    static const float *numbers(const std::vector<Box> &boxes) { return boxes.empty() ? nullptr : boxes[0].min; }
    detail::Handle<FovealCullOccludees, foveal_cull_occludees_destroy> set_;
};

/// Work that a frame is done by. Lives while a frame is rasterized.
class Jobs {
public:
    const FovealCullJobs *get() const noexcept { return &jobs_; }
    virtual ~Jobs() = default;
    /// Throws what a job system threw. The culler calls it after each frame.
    virtual void rethrow() {}

protected:
    Jobs() = default;
    Jobs(const Jobs &) = delete;
    Jobs &operator=(const Jobs &) = delete;
    FovealCullJobs jobs_{};
};

/// The engine's own job system: `run(tasks, task)` calls task(i) once for every i below `tasks`, in any
/// order and on any threads, and returns when all are done. One JobSystem serves one culler at a time: two
/// frames at once need two. Where `run` throws, rasterize finishes the frame and throws the same; `run` must
/// have seen to it that none of the tasks that it queued is called after that.
class JobSystem : public Jobs {
public:
    using Task = std::function<void(std::uint32_t)>;
    using Run = std::function<void(std::uint32_t, const Task &)>;

    JobSystem(std::uint32_t count, Run run) : run_(std::move(run)) {
        jobs_.size = sizeof jobs_;
        jobs_.count = count;
        jobs_.user = this;
        jobs_.run = [](void *user, std::uint32_t tasks, FovealCullTask task, void *context) {
            static_cast<JobSystem *>(user)->all(tasks, task, context);
        };
    }
    void rethrow() override {
#if defined(__cpp_exceptions) || defined(_CPPUNWIND)
        if (thrown_) {
            std::rethrow_exception(std::exchange(thrown_, nullptr));
        }
#endif
    }

private:
    // No exception may cross C: what was not run the library runs itself.
    void all(std::uint32_t tasks, FovealCullTask task, void *context) noexcept {
#if defined(__cpp_exceptions) || defined(_CPPUNWIND)
        try {
            run_(tasks, [=](std::uint32_t i) { task(context, i); });
        } catch (...) {
            thrown_ = std::current_exception();
        }
#else
        run_(tasks, [=](std::uint32_t i) { task(context, i); });
#endif
    }
    Run run_;
    std::exception_ptr thrown_;
};

/// Threads of the library.
class Threads : public Jobs {
public:
    explicit Threads(std::uint32_t count) {
        FovealCullThreads *threads = nullptr;
        expect_ok(foveal_cull_threads_create(count, &threads));
        threads_.reset(threads);
        expect_ok(foveal_cull_threads_jobs(threads, &jobs_));
    }

private:
    detail::Handle<FovealCullThreads, foveal_cull_threads_destroy> threads_;
};

/// A culler with its occlusion buffer. Tests may run on many threads at once.
class Culler {
public:
    Culler(std::uint32_t width_px, std::uint32_t height_px) {
        FovealCuller *culler = nullptr;
        expect_ok(foveal_culler_create(width_px, height_px, &culler));
        culler_.reset(culler);
    }
    /// A culler for a picture of this size. Rasterize with views of View::for_picture.
    static Culler for_picture(std::uint32_t width_px, std::uint32_t height_px) {
        FovealCuller *culler = nullptr;
        expect_ok(foveal_culler_create_for_picture(width_px, height_px, &culler));
        return Culler(culler);
    }
    /// Begins a frame on the calling thread.
    void rasterize(const View &view, const Occluders &occluders, const Options &options = default_options()) {
        expect_ok(foveal_culler_rasterize(culler_.get(), view.get(), occluders.get(), &options, nullptr));
    }
    /// Begins a frame on the threads of `jobs`.
    void rasterize(const View &view, const Occluders &occluders, Jobs &jobs,
                   const Options &options = default_options()) {
        const FovealCullStatus status =
            foveal_culler_rasterize(culler_.get(), view.get(), occluders.get(), &options, jobs.get());
        jobs.rethrow();
        expect_ok(status);
    }
    void test(const Box *boxes, std::size_t count, Visibility *results, const Point &origin = {}) const {
        const float *numbers = count == 0 ? nullptr : boxes->min;
        expect_ok(foveal_culler_test_boxes(culler_.get(), numbers, count, origin.data(),
                                       reinterpret_cast<std::uint8_t *>(results)));
    }
    std::vector<Visibility> test(const std::vector<Box> &boxes, const Point &origin = {}) const {
        std::vector<Visibility> results(boxes.size());
        test(boxes.data(), boxes.size(), results.data(), origin);
        return results;
    }
    std::vector<Visibility> test(const Tree &tree) const {
        std::vector<Visibility> results(tree.size());
        expect_ok(foveal_culler_test_tree(culler_.get(), tree.get(), reinterpret_cast<std::uint8_t *>(results.data()),
                                      results.size()));
        return results;
    }
    /// `count` is the set's result_count.
    void test(const Occludees &occludees, Visibility *results, std::size_t count) const {
        expect_ok(foveal_culler_test_occludees(culler_.get(), occludees.get(),
                                               reinterpret_cast<std::uint8_t *>(results), count));
    }
    std::vector<Visibility> test(const Occludees &occludees) const {
        std::vector<Visibility> results(occludees.result_count());
        test(occludees, results.data(), results.size());
        return results;
    }
    std::pair<std::uint32_t, std::uint32_t> size() const {
        std::uint32_t width = 0, height = 0;
        expect_ok(foveal_culler_size(culler_.get(), &width, &height));
        return {width, height};
    }
    /// Row by row from the top left; 0 where nothing is proven.
    std::vector<float> depth() const {
        const auto sides = size();
        std::vector<float> pixels(static_cast<std::size_t>(sides.first) * sides.second);
        expect_ok(foveal_culler_read_depth(culler_.get(), pixels.data(), pixels.size()));
        return pixels;
    }
    FovealCullStats stats() const {
        FovealCullStats stats{};
        expect_ok(foveal_culler_stats(culler_.get(), &stats));
        return stats;
    }

    const FovealCuller *get() const noexcept { return culler_.get(); }

private:
    explicit Culler(FovealCuller *culler) : culler_(culler) {}
    detail::Handle<FovealCuller, foveal_culler_destroy> culler_;
};

/// What occluders were worth in the frames before, for `Options::usefulness`: one for each culler. In each
/// frame `observe`, then `learn`.
class Usefulness {
public:
    /// Nothing is known: all occluders are drawn.
    Usefulness() {
        FovealCullUsefulness *usefulness = nullptr;
        expect_ok(foveal_cull_usefulness_create(&usefulness));
        usefulness_.reset(usefulness);
    }
    /// Forgets all that was learned, for instance when the camera is cut to another place.
    void forget() { expect_ok(foveal_cull_usefulness_forget(usefulness_.get())); }
    /// Observes results of the culler's frame.
    void observe(const Culler &culler, const Box *boxes, std::size_t count, const Visibility *results,
                 const Point &origin = {}) {
        expect_ok(foveal_cull_usefulness_observe(usefulness_.get(), culler.get(), count == 0 ? nullptr : boxes->min,
                                                 count, origin.data(),
                                                 reinterpret_cast<const std::uint8_t *>(results)));
    }
    void observe(const Culler &culler, const std::vector<Box> &boxes, const std::vector<Visibility> &results,
                 const Point &origin = {}) {
        if (boxes.size() != results.size()) {
            FOVEAL_CULL_FAIL(FOVEAL_CULL_WRONG_LENGTH, "as many results as boxes are needed");
        }
        observe(culler, boxes.data(), boxes.size(), results.data(), origin);
    }
    /// Observes the results of a set of occludees.
    void observe(const Culler &culler, const Occludees &occludees, const std::vector<Visibility> &results) {
        expect_ok(foveal_cull_usefulness_observe_occludees(
            usefulness_.get(), culler.get(), occludees.get(), reinterpret_cast<const std::uint8_t *>(results.data()),
            results.size()));
    }
    /// Learns from what was observed since the last call. `occluders` is the set that was rasterized.
    void learn(const Culler &culler, const Occluders &occluders) {
        expect_ok(foveal_cull_usefulness_learn(usefulness_.get(), culler.get(), occluders.get()));
    }
    const FovealCullUsefulness *get() const noexcept { return usefulness_.get(); }

private:
    detail::Handle<FovealCullUsefulness, foveal_cull_usefulness_destroy> usefulness_;
};

/// The places of one shadow map where a shadow can be seen. `receive` what the camera sees, then `cull` casters.
class ReceiverMask {
public:
    /// An empty mask for a square shadow map of so many texels per side, as a light sees it.
    ReceiverMask(const View &light, std::uint32_t shadow_map_px) {
        FovealCullReceiverMask *mask = nullptr;
        expect_ok(foveal_cull_receiver_mask_create(light.get(), shadow_map_px, &mask));
        mask_.reset(mask);
    }
    /// Empties it and takes another shadow map. The reach stays.
    void reset(const View &light, std::uint32_t shadow_map_px) {
        expect_ok(foveal_cull_receiver_mask_reset(mask_.get(), light.get(), shadow_map_px));
    }
    /// How far beside a place lookups read, for receivers that are entered from now on.
    void set_reach(double texels, double metres) {
        expect_ok(foveal_cull_receiver_mask_set_reach(mask_.get(), texels, metres));
    }
    void clear() { expect_ok(foveal_cull_receiver_mask_clear(mask_.get())); }
    /// Whether no receiver meets the shadow map, which then need not be drawn.
    bool empty() const {
        std::uint32_t empty = 0;
        expect_ok(foveal_cull_receiver_mask_is_empty(mask_.get(), &empty));
        return empty != 0;
    }
    /// Enters the boxes that `results` call visible.
    void receive(const Box *boxes, std::size_t count, const Visibility *results, const Point &origin = {}) {
        expect_ok(foveal_cull_receiver_mask_receive(mask_.get(), count == 0 ? nullptr : boxes->min, count,
                                                    origin.data(), reinterpret_cast<const std::uint8_t *>(results)));
    }
    void receive(const std::vector<Box> &boxes, const std::vector<Visibility> &results, const Point &origin = {}) {
        same_length(boxes.size(), results.size());
        receive(boxes.data(), boxes.size(), results.data(), origin);
    }
    /// Leaves out casters whose shadows fall on no receiver: changes results that are visible.
    void cull(const Box *boxes, std::size_t count, Visibility *results, const Point &origin = {}) const {
        expect_ok(foveal_cull_receiver_mask_cull(mask_.get(), count == 0 ? nullptr : boxes->min, count,
                                                 origin.data(), reinterpret_cast<std::uint8_t *>(results)));
    }
    void cull(const std::vector<Box> &boxes, std::vector<Visibility> &results, const Point &origin = {}) const {
        same_length(boxes.size(), results.size());
        cull(boxes.data(), boxes.size(), results.data(), origin);
    }
    const FovealCullReceiverMask *get() const noexcept { return mask_.get(); }

private:
    static void same_length(std::size_t boxes, std::size_t results) {
        if (boxes != results) {
            FOVEAL_CULL_FAIL(FOVEAL_CULL_WRONG_LENGTH, "as many results as boxes are needed");
        }
    }
    detail::Handle<FovealCullReceiverMask, foveal_cull_receiver_mask_destroy> mask_;
};

} // namespace cull
} // namespace foveal

#endif
