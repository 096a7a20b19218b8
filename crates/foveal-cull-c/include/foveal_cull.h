/* foveal-cull: software occlusion culling on the CPU.
 *
 * Occluders are rasterized into a small occlusion buffer, and boxes are tested against it. What is
 * reported as hidden is hidden: nothing is culled that the pixel centres of a picture of the buffer's
 * size, or of four times its size per axis, would show.
 *
 * Pictures. The buffer has a quarter of the picture's size per axis, rounded up: (width + 3) / 4 by
 * (height + 3) / 4 pixels. Where a side of the picture is no multiple of 4, the buffer reaches beyond the
 * picture on the right or at the bottom, and the view must be wider by as much. Otherwise things are culled
 * that show through slits narrower than a pixel. foveal_culler_create_for_picture makes such a buffer and
 * foveal_cull_view_for_picture widens the view. The size is that at which the frame is drawn, before any
 * upscaling. A frame with a temporal jitter needs the view of the matrix that has the jitter: the buffer's
 * samples are then that frame's. A picture of several samples in a pixel needs a validity radius: a tiny one
 * holds at every point of the picture.
 *
 * Space. Lengths are metres. Right-handed with y up, eyes look along their own -z; matrices of other
 * worlds are taken by foveal_cull_eye_from_matrix. World positions are double, boxes float relative to
 * an origin. The front of a triangle is the side that (b - a) x (c - a) points to.
 *
 * Errors. Functions return a FovealCullStatus. Noticed are null and misaligned pointers, wrong lengths,
 * arrays for results that overlap the boxes or ids of the same call, numbers that are not finite or out of
 * their range, ids of removed objects and of other sets, unknown enumerators, structs of another version,
 * and an object that another thread is changing. Not noticed, and undefined as in free(), are destroyed
 * objects, arrays that are shorter than said, and structs that are smaller than their `size`, or the size
 * given to a function named _sized, says: up to 4,096 bytes of that are read or written. A function that
 * fails leaves its result as it was or null, and its object unchanged, unless it says otherwise.
 *
 * Threads. Functions that take const objects may be called from many threads at once. A function that
 * changes an object returns FOVEAL_CULL_BUSY while another call uses it, and so do calls that use an
 * object while another one changes it: tests of a culler that is rasterizing, for instance. No function
 * waits for an object. Cullers that rasterize on the same FovealCullThreads take turns with them. A task
 * that these threads run may rasterize on them too, which its own thread then does alone; but it must not
 * wait for another thread that rasterizes or runs tasks on them.
 *
 * Structs begin with their size: set `size` to sizeof, or use the init function. New versions only add
 * fields at the end. Functions named _sized take the size of the struct that the caller has and write no
 * more; the functions without the word pass the sizeof of this header. FovealCullEye,
 * FovealCullOccluderId and FovealCullOccludeeId have no size and never change. Strides and sizes are bytes.
 *
 * Memory is allocated by the library's own allocator, which cannot be replaced.
 *
 * Licence: MIT or Apache-2.0.
 */
#ifndef FOVEAL_CULL_H
#define FOVEAL_CULL_H

#include <stddef.h>
#include <stdint.h>

/* The version of this header: major << 24 | minor << 12 | patch. */
#define FOVEAL_CULL_VERSION 0x00001000u

#ifdef __cplusplus
extern "C" {
#endif

/* The result of a call. */
typedef enum FovealCullStatus {
    /* Done. */
    FOVEAL_CULL_OK = 0,
    /* A pointer is null that may not be. */
    FOVEAL_CULL_NULL_POINTER = 1,
    /* A struct's `size` is none that the library knows, or what is newer in it is not zero. */
    FOVEAL_CULL_BAD_STRUCT_SIZE = 2,
    /* A count, a stride, an enumerator or a pointer's alignment is not allowed, an array for results
     * overlaps the boxes or ids of the call, an id to be removed is listed twice, or a rebuild is not built
     * yet or was adopted. */
    FOVEAL_CULL_BAD_ARGUMENT = 3,
    /* A number is not finite, or out of its range: negative, or zero where it must be above zero. */
    FOVEAL_CULL_NOT_FINITE = 4,
    /* A buffer side of 0 pixels or of more than 4,096, or a picture's or a shadow map's of 0 or of more than
     * 16,384. */
    FOVEAL_CULL_BAD_SIZE = 5,
    /* A view cannot be culled for. */
    FOVEAL_CULL_BAD_VIEW = 6,
    /* A list of indices is not a list of triangles, or names a vertex that is not there. */
    FOVEAL_CULL_BAD_INDICES = 7,
    /* A mesh has too many triangles. */
    FOVEAL_CULL_TOO_LARGE = 8,
    /* Two lists that belong together differ in length. */
    FOVEAL_CULL_WRONG_LENGTH = 9,
    /* No occluder has this id, for instance since it was removed. */
    FOVEAL_CULL_UNKNOWN_OCCLUDER = 10,
    /* The id, or the hierarchy, belongs to another set. */
    FOVEAL_CULL_OTHER_SET = 11,
    /* The object is in use by another call. */
    FOVEAL_CULL_BUSY = 12,
    /* An error inside the library. Please report it. The object stays usable, but for a rebuild that could
     * not be built. */
    FOVEAL_CULL_INTERNAL = 13,
    /* Bytes are not a baked mesh of this version. */
    FOVEAL_CULL_BAD_MESH_BYTES = 14,
    /* No occludee has this id, for instance since it was removed. */
    FOVEAL_CULL_UNKNOWN_OCCLUDEE = 15
} FovealCullStatus;

/* The result for one box, one byte each. Draw what is FOVEAL_CULL_VISIBLE. */
typedef enum FovealCullVisibility {
    /* May be seen. Also boxes that are not volumes, and everything after a frame that failed. */
    FOVEAL_CULL_VISIBLE = 0,
    /* Outside the view frustum. */
    FOVEAL_CULL_OUTSIDE = 1,
    /* Below the size threshold. */
    FOVEAL_CULL_SMALL = 2,
    /* Hidden behind occluders. */
    FOVEAL_CULL_OCCLUDED = 3
} FovealCullVisibility;

/* The depths of the near and the far plane in clip space, z / w. */
typedef enum FovealCullDepth {
    /* 0 at the near plane, 1 at the far plane: Vulkan, Direct3D, Metal, WebGPU. */
    FOVEAL_CULL_DEPTH_ZERO_TO_ONE = 0,
    /* 1 at the near plane, 0 at the far plane or at infinity: reversed depth. */
    FOVEAL_CULL_DEPTH_ONE_TO_ZERO = 1,
    /* -1 at the near plane, 1 at the far plane: OpenGL. */
    FOVEAL_CULL_DEPTH_MINUS_ONE_TO_ONE = 2
} FovealCullDepth;

/* A baked mesh. Never changes; any number of occluders may be made of it. */
typedef struct FovealCullMesh FovealCullMesh;
/* A set of occluders: baked meshes placed in the world. */
typedef struct FovealCullOccluders FovealCullOccluders;
/* A hierarchy over boxes that are tested in many frames. */
typedef struct FovealCullTree FovealCullTree;
/* A set of occludees that come, move and go, with a hierarchy that follows them. */
typedef struct FovealCullOccludees FovealCullOccludees;
/* The occludees of a set at one moment, then a new hierarchy over them. */
typedef struct FovealCullRebuild FovealCullRebuild;
/* The places of one shadow map where a shadow can be seen, and how far from the light they are. */
typedef struct FovealCullReceiverMask FovealCullReceiverMask;
/* What each cluster of the occluders was worth in the frames before. */
typedef struct FovealCullUsefulness FovealCullUsefulness;
/* A culler with its occlusion buffer: one per view that is tested at the same time. */
typedef struct FovealCuller FovealCuller;
/* Threads of the library. */
typedef struct FovealCullThreads FovealCullThreads;

/* The id of one occluder. The id of a removed occluder never names another one. All zero: none. */
typedef struct FovealCullOccluderId {
    /* The set that it belongs to. */
    uint64_t set;
    /* The occluder in it. */
    uint64_t occluder;
} FovealCullOccluderId;

/* The id of one occludee. The id of a removed occludee never names another one. All zero: none. */
typedef struct FovealCullOccludeeId {
    /* The set that it belongs to. */
    uint64_t set;
    /* The occludee in it. */
    uint64_t occludee;
} FovealCullOccludeeId;

/* Triangles to be baked. */
typedef struct FovealCullMeshSource {
    /* sizeof(FovealCullMeshSource). */
    uint32_t size;
    /* Bytes of an index: 2 or 4. */
    uint32_t index_bytes;
    /* x, y and z of the first vertex, metres. Need not be aligned. */
    const float *positions;
    /* Number of vertices. */
    size_t position_count;
    /* Bytes from one vertex to the next, at least 12. */
    size_t position_stride;
    /* Three indices per triangle. Need not be aligned. */
    const void *indices;
    /* Number of indices. */
    size_t index_count;
    /* 1: triangles occlude from behind too. 0: only from the front. */
    uint32_t two_sided;
    /* 1: bake what results for two eyes or a radius need. 0: less memory and time. */
    uint32_t adjacency;
    /* 1: occluders of the mesh can be given other positions (foveal_cull_occluders_deform). Then only
     * vertices with the same index are one. 0: they cannot. */
    uint32_t deformable;
    /* 1: bake a few boxes inside a closed mesh in its place where they are the better occluder: for
     * what is drawn with back-face culling and without holes. Boxes hide nothing where a near plane
     * may cut the mesh's bounds. 0, and for meshes that are two-sided, deformable or open: the mesh
     * itself. */
    uint32_t inner_shape;
} FovealCullMeshSource;

/* One eye: a rigid pose and a frustum. */
typedef struct FovealCullEye {
    /* Columns: the eye's right, up and backward axes and its position (world, metres). */
    double world_from_eye[12];
    /* Edges: tangents, or metres if orthographic. */
    double left;
    double right;
    double bottom;
    double top;
    /* Near distance, metres. */
    double near_m;
    /* Far distance, metres; may be infinite unless orthographic. */
    double far_m;
    /* 1: rays are parallel. 0: they meet in the eye. */
    uint32_t orthographic;
    /* 0. */
    uint32_t reserved;
} FovealCullEye;

/* The camera view of a frame. */
typedef struct FovealCullView {
    /* sizeof(FovealCullView). */
    uint32_t size;
    /* 1, or 2 with one result that holds for both eyes. */
    uint32_t eye_count;
    /* The eye, or the left and the right one. */
    FovealCullEye eyes[2];
    /* Distance that each eye may move while the results hold, metres; 0 for the given places, not negative. */
    double validity_radius_m;
} FovealCullView;

/* Thresholds and switches of one frame. Thresholds are finite and not negative. */
typedef struct FovealCullFrameOptions {
    /* sizeof(FovealCullFrameOptions). */
    uint32_t size;
    /* 1: occluders are drawn. 0: frustum and size only. */
    uint32_t occlusion;
    /* Size threshold for occluders, in square roots of a metre: what it leaves out depends on the scene's
     * scale. Occluders with radius^2 < distance * threshold^2 * tan(fov_y / 2) are left out, where the radius
     * is that of the bounding sphere and the distance, along the view direction, is above 1 m. Orthographic
     * views leave out none. 0 (the default) takes all. */
    float occluder_size_threshold;
    /* Least screen area of a cluster (up to 64 quads of an occluder), pixels of the buffer per quad; 6 by
     * default, 0 takes all. The area is that of the cluster's screen rectangle, times the part of it that the
     * cluster's triangles can fill. Fine detail costs much and hides little. With two eyes or a validity
     * radius, clusters that would lose most of their area to silhouette margins are left out whatever this
     * says. */
    float occluder_pixels_per_quad;
    /* Size threshold for boxes (FOVEAL_CULL_SMALL), as the one for occluders. 0 (the default) culls none by
     * size. */
    float occludee_size_threshold;
    /* 0. */
    uint32_t reserved;
    /* Reads a clock, nanoseconds; null for no time limit. Called from the threads of the jobs. Must
     * not throw. */
    uint64_t (*clock)(void *user);
    /* Passed to `clock`. */
    void *clock_user;
    /* Clock reading at or after which no further cluster is begun, nanoseconds. */
    uint64_t deadline_ns;
    /* What occluders were worth in the frames before: those that hid nothing are left out, and with a time limit
     * those are drawn that hide most for their time. Null to draw all, nearest first. */
    const FovealCullUsefulness *usefulness;
} FovealCullFrameOptions;

/* A task of a batch: call it with the batch's context and a number. It does not fail. */
typedef void (*FovealCullTask)(void *context, uint32_t index);

/* Calls task(context, i) once for every i below `tasks`, in any order and on any threads, and returns
 * when all are done. No task may be called after that. Must not throw. */
typedef void (*FovealCullRun)(void *user, uint32_t tasks, FovealCullTask task, void *context);

/* Announces that there will be work soon. Returns at once. Must not throw. */
typedef void (*FovealCullWake)(void *user);

/* A job system. Its functions are called from the thread that calls the library. */
typedef struct FovealCullJobs {
    /* sizeof(FovealCullJobs). */
    uint32_t size;
    /* Number of tasks that can run at once, 1 to 256. */
    uint32_t count;
    /* Passed to the functions. */
    void *user;
    /* Runs the tasks of a batch. */
    FovealCullRun run;
    /* May be null. */
    FovealCullWake wake;
} FovealCullJobs;

/* Stats of a frame. */
typedef struct FovealCullStats {
    /* sizeof(FovealCullStats). */
    uint32_t size;
    /* 0. */
    uint32_t reserved;
    /* Enabled occluders in the set. */
    uint64_t occluder_models;
    /* Occluders of which at least one cluster was drawn. */
    uint64_t occluder_models_rasterized;
    /* Triangles of all enabled occluders. */
    uint64_t occluder_triangles;
    /* Triangles of the clusters that were drawn. */
    uint64_t occluder_triangles_rasterized;
    /* Convex polygons that survived set-up. */
    uint64_t polygons_rasterized;
    /* Clusters of all enabled occluders. */
    uint64_t clusters;
    /* Clusters that were drawn. */
    uint64_t clusters_rasterized;
    /* Clusters left out because the time was spent. */
    uint64_t clusters_over_budget;
    /* Clusters left out because they hid nothing in the frames before. */
    uint64_t clusters_not_useful;
} FovealCullStats;

/* ---- Version and errors ---- */

/* The version of the library: major << 24 | minor << 12 | patch. Below 1.0 a program must run with the
 * minor version that it was compiled for. */
uint32_t foveal_cull_version(void);

/* The version of the library as text. */
const char *foveal_cull_version_text(void);

/* The text of a status, never null. */
const char *foveal_cull_status_text(int32_t status);

/* Copies the text of this thread's last failure, which says more than its status: at most `size` bytes
 * with the final zero. Returns the bytes that all of it needs. `text` may be null. */
size_t foveal_cull_last_error(char *text, size_t size);

/* ---- Meshes: bake when a level loads, about 0.8 microseconds per triangle, 0.5 without adjacency ---- */

/* Fills a source with defaults: one-sided, with adjacency, 32-bit indices, stride 12, no triangles. */
FovealCullStatus foveal_cull_mesh_source_init_sized(FovealCullMeshSource *source, size_t size);
static inline FovealCullStatus foveal_cull_mesh_source_init(FovealCullMeshSource *source) {
    return foveal_cull_mesh_source_init_sized(source, sizeof(FovealCullMeshSource));
}

/* Bakes a mesh. The source's arrays are not needed afterwards. */
FovealCullStatus foveal_cull_mesh_bake(const FovealCullMeshSource *source, FovealCullMesh **out);

/* Bakes a box whose faces look outwards, min to max (three numbers each) in mesh space, metres. */
FovealCullStatus foveal_cull_mesh_from_box(const float *min, const float *max, FovealCullMesh **out);

/* Bakes a terrain of a grid of heights that is seen from above (+y): sample i of row j lies at x =
 * (float)i * spacing_x, y = heights[j * columns + i], z = (float)j * spacing_z, metres. Spacings are above 0.
 * Every `step`th sample is kept, and the surface lies under the terrain everywhere: fewer triangles, which hide
 * somewhat less. NaN is a hole: cells with one are left out. The ground is solid besides: nothing may be seen
 * under the surface, neither through its sides nor, except over holes, from below. A step of 0 is one of 1.
 * Heights are aligned as floats are: other than a source's positions. */
FovealCullStatus foveal_cull_mesh_from_heights(const float *heights, size_t columns, size_t rows,
                                               float spacing_x, float spacing_z, size_t step,
                                               FovealCullMesh **out);

/* Copies a baked mesh as bytes, for a file: all of them, or none if they are more than `size`. Returns how
 * many it has; 0 for null. `bytes` may be null to ask for that. The same on every machine. A
 * deformable mesh keeps the shape that it has, and can be deformed no more. */
size_t foveal_cull_mesh_to_bytes(const FovealCullMesh *mesh, uint8_t *bytes, size_t size);

/* The mesh of foveal_cull_mesh_to_bytes, without baking. Bytes that were changed, or come from elsewhere or
 * from another version of the format, are FOVEAL_CULL_BAD_MESH_BYTES; but the checksum is no signature: bytes
 * that somebody made may be another valid mesh. They are not needed afterwards. */
FovealCullStatus foveal_cull_mesh_from_bytes(const uint8_t *bytes, size_t size, FovealCullMesh **out);

/* Drops a mesh. Occluders that were made of it keep it. Null is nothing. */
void foveal_cull_mesh_destroy(FovealCullMesh *mesh);

/* The number of triangles, without degenerate ones (in a deformable mesh only those with the same index
 * twice are); of an inner shape those of its boxes; 0 for null. */
size_t foveal_cull_mesh_triangle_count(const FovealCullMesh *mesh);

/* ---- Occluders ---- */

/* Makes an empty set. */
FovealCullStatus foveal_cull_occluders_create(FovealCullOccluders **out);

/* Drops a set with its occluders. Null is nothing. */
void foveal_cull_occluders_destroy(FovealCullOccluders *occluders);

/* Places a mesh in the world. `world_from_mesh` has twelve numbers: the columns x axis, y axis, z axis
 * and translation; any affine map will do. Null is the identity. */
FovealCullStatus foveal_cull_occluders_add(FovealCullOccluders *occluders, const FovealCullMesh *mesh,
                                           const double *world_from_mesh, FovealCullOccluderId *out);

/* Moves `count` occluders, with twelve numbers each. After an error none has moved. */
FovealCullStatus foveal_cull_occluders_move(FovealCullOccluders *occluders, const FovealCullOccluderId *ids,
                                            const double *world_from_mesh, size_t count);

/* Gives an occluder of a deformable mesh another shape: all `count` positions of the mesh in their order,
 * `stride` bytes apart. Other occluders of the mesh keep theirs. After an error it keeps its shape. */
FovealCullStatus foveal_cull_occluders_deform(FovealCullOccluders *occluders, FovealCullOccluderId id,
                                              const float *positions, size_t count, size_t stride);

/* Switches an occluder off (0) or on (1). A new one is on. */
FovealCullStatus foveal_cull_occluders_enable(FovealCullOccluders *occluders, FovealCullOccluderId id,
                                              uint32_t enabled);

/* Removes an occluder. Its id names nothing from then on. */
FovealCullStatus foveal_cull_occluders_remove(FovealCullOccluders *occluders, FovealCullOccluderId id);

/* Writes the number of occluders, whether on or off. */
FovealCullStatus foveal_cull_occluders_count(const FovealCullOccluders *occluders, size_t *out);

/* ---- Views ---- */

/* The eye of a matrix from the world to clip space, 16 numbers, column-major. `depth` is a
 * FovealCullDepth. The matrix may be perspective or orthographic, asymmetric, with the far plane at
 * infinity, with y up or down, and for a right- or a left-handed world. In a left-handed world the rows
 * of foveal_culler_read_depth count from the bottom. Refused are matrices that are singular or shear,
 * and oblique near planes. */
FovealCullStatus foveal_cull_eye_from_matrix(const double *clip_from_world, uint32_t depth, FovealCullEye *out);

/* The same with a matrix of floats. It loses what the renderer's own loses far from the world's origin;
 * add the way to the position where matrices are relative to the camera. */
FovealCullStatus foveal_cull_eye_from_matrix_f32(const float *clip_from_world, uint32_t depth, FovealCullEye *out);

/* A symmetric perspective eye without a far plane. Position, target and up have three numbers each,
 * world metres. Where the target is the position, the eye looks along -z. `up` need not be perpendicular to
 * the view direction; where it is parallel to it, another axis is taken. `fov_y_rad` is the vertical field of
 * view in radians, above 0 and below pi; `aspect` is width over height, above 0; `near_m` is above 0, metres.
 * Other numbers are FOVEAL_CULL_BAD_VIEW, NaN and infinity FOVEAL_CULL_NOT_FINITE. */
FovealCullStatus foveal_cull_eye_look_at(const double *position, const double *target, const double *up,
                                         double fov_y_rad, double aspect, double near_m, FovealCullEye *out);

/* A view of one eye at its exact place. For two eyes set `eye_count` and `eyes[1]`. */
FovealCullStatus foveal_cull_view_init_sized(const FovealCullEye *eye, FovealCullView *out, size_t size);
static inline FovealCullStatus foveal_cull_view_init(const FovealCullEye *eye, FovealCullView *out) {
    return foveal_cull_view_init_sized(eye, out, sizeof(FovealCullView));
}

/* Widens a view of a picture of `width_px` x `height_px` pixels, 1 to 16,384 per side, for a culler of
 * foveal_culler_create_for_picture with the same size: to the right and downwards, to whole pixels of the
 * buffer. The samples of the buffer are then the picture's pixel centres. Sides that are multiples of 4 change
 * nothing. Call it once for each view, after its last eye is set: a second call widens it again. Receiver masks
 * take the light's view as it was before. */
FovealCullStatus foveal_cull_view_for_picture(FovealCullView *view, uint32_t width_px, uint32_t height_px);

/* ---- Threads ---- */

/* Starts `count` - 1 threads; the calling thread is the last one. 1 to 256. Threads that the system refuses
 * are left out: the `count` of foveal_cull_threads_jobs says how many there are. */
FovealCullStatus foveal_cull_threads_create(uint32_t count, FovealCullThreads **out);

/* Joins the threads. Null is nothing. */
void foveal_cull_threads_destroy(FovealCullThreads *threads);

/* The threads as a job system, which lives as long as they do. */
FovealCullStatus foveal_cull_threads_jobs_sized(const FovealCullThreads *threads, FovealCullJobs *out,
                                                size_t size);
static inline FovealCullStatus foveal_cull_threads_jobs(const FovealCullThreads *threads, FovealCullJobs *out) {
    return foveal_cull_threads_jobs_sized(threads, out, sizeof(FovealCullJobs));
}

/* ---- Trees of boxes ---- */

/* Builds a tree over `count` boxes of six floats each (min, then max), metres relative to `origin` (three
 * numbers; null is zero). */
FovealCullStatus foveal_cull_tree_build(const float *boxes, size_t count, const double *origin,
                                        FovealCullTree **out);

/* Takes new boxes for the same objects, moved or resized. */
FovealCullStatus foveal_cull_tree_refit(FovealCullTree *tree, const float *boxes, size_t count);

/* Drops a tree. Null is nothing. */
void foveal_cull_tree_destroy(FovealCullTree *tree);

/* ---- Occludees that come, move and go ----
 *
 * In each frame: insert, move and remove, refit once, then foveal_culler_test_occludees. Now and then, when
 * foveal_cull_occludees_wants_rebuild says so, build the hierarchy again: by foveal_cull_occludees_rebuild,
 * or on another thread while frames go on, by a snapshot that is built there and adopted afterwards. Results
 * are right without it too; tests take longer. */

/* Makes an empty set for boxes in metres relative to `origin` (three numbers; null is zero). */
FovealCullStatus foveal_cull_occludees_create(const double *origin, FovealCullOccludees **out);

/* Drops a set with its occludees. Null is nothing. */
void foveal_cull_occludees_destroy(FovealCullOccludees *occludees);

/* Inserts `count` occludees with boxes of six floats each (min, then max), and writes their ids to `out`. A
 * box that is not a volume is always visible. Constant time for each. A set has at most 2^28 occludees. After
 * an error none was inserted. */
FovealCullStatus foveal_cull_occludees_insert(FovealCullOccludees *occludees, const float *boxes, size_t count,
                                              FovealCullOccludeeId *out);

/* Moves or resizes `count` occludees, with six floats each. Constant time for each. The last box counts for an
 * id that is listed twice. After an error none has moved. */
FovealCullStatus foveal_cull_occludees_move(FovealCullOccludees *occludees, const FovealCullOccludeeId *ids,
                                            const float *boxes, size_t count);

/* Removes `count` occludees. Their ids name nothing from then on. After an error, as by an id that is listed
 * twice (FOVEAL_CULL_BAD_ARGUMENT), none was removed. */
FovealCullStatus foveal_cull_occludees_remove(FovealCullOccludees *occludees, const FovealCullOccludeeId *ids,
                                              size_t count);

/* Writes 1 if the id names an occludee of this set, 0 if not. */
FovealCullStatus foveal_cull_occludees_contains(const FovealCullOccludees *occludees, FovealCullOccludeeId id,
                                                uint32_t *out);

/* Writes the box of an occludee, six floats. */
FovealCullStatus foveal_cull_occludees_bounds(const FovealCullOccludees *occludees, FovealCullOccludeeId id,
                                              float *out);

/* Writes the places that `count` occludees have among the results of foveal_culler_test_occludees. The place
 * of an occludee never changes; when it is removed another one may get it. */
FovealCullStatus foveal_cull_occludees_indices(const FovealCullOccludees *occludees,
                                               const FovealCullOccludeeId *ids, size_t count, uint32_t *out);

/* Writes the number of occludees. */
FovealCullStatus foveal_cull_occludees_count(const FovealCullOccludees *occludees, size_t *out);

/* Writes the number of results: more than the largest index. It never falls. */
FovealCullStatus foveal_cull_occludees_result_count(const FovealCullOccludees *occludees, size_t *out);

/* Fits the hierarchy to what has moved. Call it once before the tests of a frame; without it boxes are tested
 * one by one, which is as right but slower. */
FovealCullStatus foveal_cull_occludees_refit(FovealCullOccludees *occludees);

/* Writes 1 if the hierarchy is worth being built again, since many occludees are new or have moved away from
 * their neighbours; 0 if not. */
FovealCullStatus foveal_cull_occludees_wants_rebuild(const FovealCullOccludees *occludees, uint32_t *out);

/* Builds the hierarchy again on this thread, about half a microsecond per occludee. */
FovealCullStatus foveal_cull_occludees_rebuild(FovealCullOccludees *occludees);

/* Copies what foveal_cull_rebuild_build needs. The set may change and be tested while it is built, and may
 * even be destroyed. */
FovealCullStatus foveal_cull_occludees_snapshot(const FovealCullOccludees *occludees, FovealCullRebuild **out);

/* Builds the hierarchy of a snapshot, on any thread. What is built already stays. FOVEAL_CULL_BUSY while
 * another thread builds it, FOVEAL_CULL_BAD_ARGUMENT once it was adopted. After FOVEAL_CULL_INTERNAL the
 * snapshot is gone: this function, foveal_cull_rebuild_is_built and foveal_cull_occludees_adopt return that
 * from then on. Take a new one. */
FovealCullStatus foveal_cull_rebuild_build(FovealCullRebuild *rebuild);

/* Writes 1 if the hierarchy is built, whether adopted or not, 0 if not yet. May be called while another thread
 * builds it. */
FovealCullStatus foveal_cull_rebuild_is_built(const FovealCullRebuild *rebuild, uint32_t *out);

/* Gives a hierarchy to the set that the snapshot is of, fits it to what has moved since and leaves out what
 * was removed. FOVEAL_CULL_BUSY while it is being built, FOVEAL_CULL_BAD_ARGUMENT if building has not begun or
 * it was adopted already, FOVEAL_CULL_OTHER_SET for another set. Destroy the rebuild afterwards. */
FovealCullStatus foveal_cull_occludees_adopt(FovealCullOccludees *occludees, FovealCullRebuild *rebuild);

/* Drops a snapshot or a hierarchy, not before foveal_cull_rebuild_build has returned on the thread that calls
 * it: that it is built is not enough. Null is nothing. */
void foveal_cull_rebuild_destroy(FovealCullRebuild *rebuild);

/* ---- Cullers ---- */

/* Fills options with the defaults. */
FovealCullStatus foveal_cull_frame_options_init_sized(FovealCullFrameOptions *options, size_t size);
static inline FovealCullStatus foveal_cull_frame_options_init(FovealCullFrameOptions *options) {
    return foveal_cull_frame_options_init_sized(options, sizeof(FovealCullFrameOptions));
}

/* Makes a culler for a picture of this size, 1 to 16,384 pixels per side: the buffer has a quarter of it per
 * axis, rounded up. Rasterize with views of foveal_cull_view_for_picture. A shadow map is a picture too. */
FovealCullStatus foveal_culler_create_for_picture(uint32_t width_px, uint32_t height_px, FovealCuller **out);

/* Makes a culler with an occlusion buffer of this size, 1 to 4,096 pixels per side. Larger buffers report
 * fewer hidden boxes as visible and take longer. A size that is neither the picture's nor a quarter of it needs
 * a validity radius, or boxes that show between the samples are culled. */
FovealCullStatus foveal_culler_create(uint32_t width_px, uint32_t height_px, FovealCuller **out);

/* Drops a culler. Null is nothing. */
void foveal_culler_destroy(FovealCuller *culler);

/* Writes the size of the buffer, pixels. */
FovealCullStatus foveal_culler_size(const FovealCuller *culler, uint32_t *width_px, uint32_t *height_px);

/* Begins a frame: clears the buffer and draws the occluders that the view can see. `options` may be null
 * for the defaults, `jobs` for the calling thread alone. After an error everything is visible until the
 * next good frame, unless `culler` itself was busy. */
FovealCullStatus foveal_culler_rasterize(FovealCuller *culler, const FovealCullView *view,
                                         const FovealCullOccluders *occluders,
                                         const FovealCullFrameOptions *options, const FovealCullJobs *jobs);

/* Classifies `count` boxes of six floats each (min, then max), metres relative to `origin` (three numbers;
 * null is zero), against the last frame. `results` gets a FovealCullVisibility per box, one byte each. */
FovealCullStatus foveal_culler_test_boxes(const FovealCuller *culler, const float *boxes, size_t count,
                                          const double *origin, uint8_t *results);

/* Classifies the boxes of a tree. `count` is the number of its boxes. */
FovealCullStatus foveal_culler_test_tree(const FovealCuller *culler, const FovealCullTree *tree,
                                         uint8_t *results, size_t count);

/* Classifies the occludees of a set. `count` is that of foveal_cull_occludees_result_count, and results lie
 * where foveal_cull_occludees_indices says; those at places that no occludee has mean nothing. */
FovealCullStatus foveal_culler_test_occludees(const FovealCuller *culler, const FovealCullOccludees *occludees,
                                              uint8_t *results, size_t count);

/* Copies the depth of the last frame, row by row from the top left, for pictures while debugging:
 * near / distance, or 1 at the near to 0 at the far plane if orthographic; 0 where nothing is proven.
 * `count` is width * height. */
FovealCullStatus foveal_culler_read_depth(const FovealCuller *culler, float *pixels, size_t count);

/* Writes the stats of the last frame. `size` in the struct is written, not read. */
FovealCullStatus foveal_culler_stats_sized(const FovealCuller *culler, FovealCullStats *out, size_t size);
static inline FovealCullStatus foveal_culler_stats(const FovealCuller *culler, FovealCullStats *out) {
    return foveal_culler_stats_sized(culler, out, sizeof(FovealCullStats));
}

/* ---- Occluders that hide nothing ----
 *
 * Floors and outer walls often hide nothing that is asked for. In each frame: rasterize with `usefulness` in the
 * options, test, observe the results, learn. Clusters (up to 64 quads of an occluder) that helped to hide no box
 * for 6 to 24 frames are left out, and looked at again after 12 to 28 frames. Results stay safe, since what is
 * not drawn hides nothing, but they depend on the frames before. One object for each culler. */

/* Makes an object that knows nothing: all occluders are drawn. */
FovealCullStatus foveal_cull_usefulness_create(FovealCullUsefulness **out);

/* Drops it. Null is nothing. */
void foveal_cull_usefulness_destroy(FovealCullUsefulness *usefulness);

/* Forgets all that was learned, for instance when the camera is cut to another place. */
FovealCullStatus foveal_cull_usefulness_forget(FovealCullUsefulness *usefulness);

/* Observes the results that foveal_culler_test_boxes or foveal_culler_test_tree gave for boxes: as many calls as
 * there were tests. Up to 256 hidden boxes are looked at, others in the next frame. */
FovealCullStatus foveal_cull_usefulness_observe(FovealCullUsefulness *usefulness, const FovealCuller *culler,
                                                const float *boxes, size_t count, const double *origin,
                                                const uint8_t *results);

/* Observes the results of foveal_culler_test_occludees. */
FovealCullStatus foveal_cull_usefulness_observe_occludees(FovealCullUsefulness *usefulness,
                                                          const FovealCuller *culler,
                                                          const FovealCullOccludees *occludees,
                                                          const uint8_t *results, size_t count);

/* Learns what the occluders of the culler's frame were worth, from what was observed since the last call.
 * `occluders` is the set that was rasterized. Learns nothing if nothing was observed, or without `usefulness` in
 * the options of the frame. */
FovealCullStatus foveal_cull_usefulness_learn(FovealCullUsefulness *usefulness, const FovealCuller *culler,
                                              const FovealCullOccluders *occluders);

/* ---- Shadows ----
 *
 * The camera's culler says which boxes are visible: the receivers. foveal_cull_receiver_mask_receive enters
 * them. foveal_cull_receiver_mask_cull then leaves out casters whose shadows fall on none of them. About 0.1
 * microseconds a box.
 *
 * Leaving casters out changes no lookup in the shadow map for a place in a receiver's box that the light's
 * view shows, as long as lookups read no farther than the reach, compare planar depth texel by texel, and
 * stay within one map. Places before the near plane, beyond the far plane and beside the map have no shadow
 * here. Give a bias towards the light, and depth steps above a ten thousandth of the distance, as metres of
 * reach; filters across the seams of a cube need a wider view.
 *
 * A culler that looks from a light leaves out casters behind occluders. The map must then draw the faces that
 * occluders hide with: front faces, and both faces of meshes that are baked two-sided. A map of back faces only
 * does not hold a wall that has no back, and the shadow of what is behind the wall is lost: for such a map bake
 * the light's occluders one-sided and from closed meshes. */

/* Makes an empty mask for a square shadow map of `shadow_map_px` texels per side, 1 to 16,384, as a light sees
 * it: one view for a spot light or a cascade, six for a point light. A second eye and a validity radius of the
 * view count nothing. The near plane must lie before all casters, also where the map is drawn with depth
 * clamp. */
FovealCullStatus foveal_cull_receiver_mask_create(const FovealCullView *light, uint32_t shadow_map_px,
                                                  FovealCullReceiverMask **out);

/* Drops a mask. Null is nothing. */
void foveal_cull_receiver_mask_destroy(FovealCullReceiverMask *mask);

/* Empties a mask and takes another shadow map for it, as foveal_cull_receiver_mask_create does. The reach
 * stays. */
FovealCullStatus foveal_cull_receiver_mask_reset(FovealCullReceiverMask *mask, const FovealCullView *light,
                                                 uint32_t shadow_map_px);

/* Sets how far beside a place lookups read: up to so many texels, for instance half the width of a filter and
 * a texel more, after moving the place by up to so many metres, for instance along its normal. 2 texels and 0
 * metres unless set. Finite and not negative. Set it before foveal_cull_receiver_mask_receive: receivers that
 * were entered keep the old reach. */
FovealCullStatus foveal_cull_receiver_mask_set_reach(FovealCullReceiverMask *mask, double texels, double metres);

/* Empties a mask. The shadow map and the reach stay. */
FovealCullStatus foveal_cull_receiver_mask_clear(FovealCullReceiverMask *mask);

/* Writes 1 if no receiver meets the shadow map, which then need not be drawn; 0 if one does. The light may
 * still light what lies before its near plane, beyond its far plane, or beside its maps. */
FovealCullStatus foveal_cull_receiver_mask_is_empty(const FovealCullReceiverMask *mask, uint32_t *out);

/* Enters receivers: of `count` boxes of six floats each (min, then max), metres relative to `origin` (three
 * numbers; null is zero), those that `results` call FOVEAL_CULL_VISIBLE. A box that is not a volume is
 * everywhere. Bytes of `results` that are no FovealCullVisibility are FOVEAL_CULL_BAD_ARGUMENT. */
FovealCullStatus foveal_cull_receiver_mask_receive(FovealCullReceiverMask *mask, const float *boxes, size_t count,
                                                   const double *origin, const uint8_t *results);

/* Leaves out casters: of the boxes that `results` call FOVEAL_CULL_VISIBLE, those outside the shadow map become
 * FOVEAL_CULL_OUTSIDE, and those whose shadows fall on no receiver FOVEAL_CULL_OCCLUDED. Set `results` before:
 * all to FOVEAL_CULL_VISIBLE, or to those of foveal_culler_test_boxes with the light's view by a culler of
 * foveal_culler_create_for_picture for the map, which leaves out casters that others hide from the light. Other
 * results stay. A box that is not a volume stays visible. */
FovealCullStatus foveal_cull_receiver_mask_cull(const FovealCullReceiverMask *mask, const float *boxes,
                                                size_t count, const double *origin, uint8_t *results);

#ifdef __cplusplus
}
#endif

#endif
