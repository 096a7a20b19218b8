// The shim as a program uses it that was written for Masked Occlusion Culling. Ends with 0 if all is well.
#include "moc_shim.hpp"

#include <cstdio>
#include <thread>

namespace {

int failures = 0;

void expect(bool well, const char *what) {
    if (!well) {
        std::fprintf(stderr, "failed: %s\n", what);
        ++failures;
    }
}

struct Random {
    std::uint64_t state;
    double number(double low, double high) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        return low + (high - low) * static_cast<double>(state >> 11) / 9007199254740992.0;
    }
};

// 90 degrees, eye at the origin, along -z; x to the right, y up. Column-major.
const float clip_from_model[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, -1, 0, 0, -0.2f, 0};

void calls() {
    MaskedOcclusionCulling *moc = MaskedOcclusionCulling::Create(MaskedOcclusionCulling::AVX2);
    expect(moc->TestRect(-1, -1, 1, 1, 5) == MaskedOcclusionCulling::VISIBLE, "visible without a resolution");
    moc->SetResolution(320, 192);
    moc->SetNearClipPlane(0.1f);
    unsigned int width = 0, height = 0;
    moc->GetResolution(width, height);
    expect(width == 320 && height == 192 && moc->GetNearClipPlane() == 0.1f, "what was set is given back");
    moc->ClearBuffer();
    // Counter-clockwise from the eye, 5 m away, tightly packed.
    float wall[] = {-3, -3, -5, 3, -3, -5, 3, 3, -5, -3, 3, -5};
    const unsigned int indices[] = {0, 1, 2, 0, 2, 3};
    const MaskedOcclusionCulling::VertexLayout layout(12, 4, 8);
    const auto draw = [&](MaskedOcclusionCulling::BackfaceWinding winding) {
        return moc->RenderTriangles(wall, indices, 2, clip_from_model, winding, MaskedOcclusionCulling::CLIP_PLANE_ALL,
                                    layout);
    };
    const auto behind = [&] { return moc->TestRect(-0.3f, -0.3f, 0.3f, 0.3f, 8); };
    draw(MaskedOcclusionCulling::BACKFACE_CW);
    expect(behind() == MaskedOcclusionCulling::OCCLUDED, "a rectangle behind the wall is occluded");
    expect(moc->TestRect(-0.3f, -0.3f, 0.3f, 0.3f, 4) == MaskedOcclusionCulling::VISIBLE, "before it visible");
    expect(moc->TestRect(-0.3f, -0.3f, 0.9f, 0.3f, 8) == MaskedOcclusionCulling::VISIBLE, "past its edge visible");
    expect(moc->TestRect(1.2f, -0.3f, 1.5f, 0.3f, 8) == MaskedOcclusionCulling::VIEW_CULLED, "beside the picture");
    expect(moc->TestRect(-0.3f, -0.3f, 0.3f, 0.3f, 0.05f) == MaskedOcclusionCulling::VISIBLE, "before the near plane");
    const float nan = std::numeric_limits<float>::quiet_NaN();
    expect(moc->TestRect(nan, -0.3f, 0.3f, 0.3f, 8) == MaskedOcclusionCulling::VISIBLE, "nan is visible");
    expect(moc->TestRect(-0.3f, -0.3f, 0.3f, 0.3f, nan) == MaskedOcclusionCulling::VISIBLE, "nan is visible");
    // Triangles to test: in front of the wall, behind it, beside the picture, and back faces.
    const auto triangle = [&](float x, float z, MaskedOcclusionCulling::BackfaceWinding winding) {
        const float points[] = {x, 0, z, x + 0.5f, 0, z, x, 0.5f, z};
        return moc->TestTriangles(points, indices, 1, clip_from_model, winding, MaskedOcclusionCulling::CLIP_PLANE_ALL,
                                  layout);
    };
    expect(triangle(0, -4, MaskedOcclusionCulling::BACKFACE_CW) == MaskedOcclusionCulling::VISIBLE, "triangle before");
    expect(triangle(0, -9, MaskedOcclusionCulling::BACKFACE_CW) == MaskedOcclusionCulling::OCCLUDED, "triangle behind");
    expect(triangle(40, -9, MaskedOcclusionCulling::BACKFACE_CW) == MaskedOcclusionCulling::VIEW_CULLED, "beside");
    expect(triangle(0, -4, MaskedOcclusionCulling::BACKFACE_CCW) == MaskedOcclusionCulling::VIEW_CULLED, "back face");
    expect(triangle(0, -4, MaskedOcclusionCulling::BACKFACE_NONE) == MaskedOcclusionCulling::VISIBLE, "two-sided");
    // Behind the wall or facing away, but for one number that cannot be judged.
    for (const float odd : {nan, INFINITY, -INFINITY, 3e38f}) {
        for (int at = 0; at < 9; ++at) {
            for (const auto winding : {MaskedOcclusionCulling::BACKFACE_CW, MaskedOcclusionCulling::BACKFACE_CCW}) {
                float points[] = {0, 0, -9, 0.5f, 0, -9, 0, 0.5f, -9};
                points[at] = odd;
                float doubled[16];
                std::transform(clip_from_model, clip_from_model + 16, doubled, [](float v) { return 2 * v; });
                expect(moc->TestTriangles(points, indices, 1, doubled, winding, MaskedOcclusionCulling::CLIP_PLANE_ALL,
                                          layout) == MaskedOcclusionCulling::VISIBLE,
                       "what cannot be judged is visible");
            }
        }
    }
    // 1 / w.
    std::vector<float> depth(320 * 192);
    moc->ComputePixelDepthBuffer(depth.data(), true);
    expect(std::fabs(depth[96 * 320 + 160] - 0.2f) < 1e-3f && depth[0] == -1.0f, "depth is 1 / w");

    moc->ClearBuffer();
    expect(behind() == MaskedOcclusionCulling::VISIBLE, "nothing hides after a clear");
    draw(MaskedOcclusionCulling::BACKFACE_CCW);
    expect(behind() == MaskedOcclusionCulling::VISIBLE, "a back face hides nothing");
    draw(MaskedOcclusionCulling::BACKFACE_NONE);
    expect(behind() == MaskedOcclusionCulling::OCCLUDED, "draws and tests alternate; two-sided hides");
    // The same memory with other content is another mesh.
    moc->ClearBuffer();
    for (int i = 2; i < 12; i += 3) {
        wall[i] = -12;
    }
    draw(MaskedOcclusionCulling::BACKFACE_CW);
    expect(behind() == MaskedOcclusionCulling::VISIBLE, "the wall is behind the rectangle now");
    expect(moc->TestRect(-0.2f, -0.2f, 0.2f, 0.2f, 14) == MaskedOcclusionCulling::OCCLUDED, "and hides what is behind");
    // The same mesh twice in a frame, once in the next; meshes that are not drawn are forgotten.
    const float right[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, -1, 6, 0, -0.2f, 0};
    const auto right_rect = [&] { return moc->TestRect(0.3f, -0.1f, 0.6f, 0.1f, 14); };
    moc->RenderTriangles(wall, indices, 2, right, MaskedOcclusionCulling::BACKFACE_CW,
                         MaskedOcclusionCulling::CLIP_PLANE_ALL, layout);
    expect(right_rect() == MaskedOcclusionCulling::OCCLUDED, "the second one hides too");
    for (int frame = 0; frame < 130; ++frame) {
        moc->ClearBuffer();
        draw(MaskedOcclusionCulling::BACKFACE_CW);
        expect(right_rect() == MaskedOcclusionCulling::VISIBLE, "and is gone in the next frame");
    }
    expect(moc->GetMeshCount() == 1, "only the mesh that is drawn is kept");
    // Clip-space vertices (x, y, z, w) without a matrix; a static mesh; threads of the library.
    FovealCullThreads *threads = nullptr;
    FovealCullJobs jobs;
    expect(foveal_cull_threads_create(3, &threads) == FOVEAL_CULL_OK, "threads");
    expect(foveal_cull_threads_jobs(threads, &jobs) == FOVEAL_CULL_OK, "threads as jobs");
    moc->SetJobs(&jobs);
    moc->SetStaticMeshes(true);
    const float clip[] = {-3, -3, 0, 5, 3, -3, 0, 5, 3, 3, 0, 5, -3, 3, 0, 5};
    for (int frame = 0; frame < 3; ++frame) {
        moc->ClearBuffer();
        moc->RenderTriangles(clip, indices, 2);
        expect(behind() == MaskedOcclusionCulling::OCCLUDED, "clip space");
    }
    moc->SetJobs(nullptr);
    foveal_cull_threads_destroy(threads);
    // Tests from many threads; the first of them rasterizes.
    moc->ClearBuffer();
    moc->RenderTriangles(clip, indices, 2);
    std::atomic<int> occluded{0};
    std::vector<std::thread> many;
    for (int i = 0; i < 4; ++i) {
        many.emplace_back([&] {
            for (int k = 0; k < 100; ++k) {
                occluded += behind() == MaskedOcclusionCulling::OCCLUDED;
            }
        });
    }
    for (auto &thread : many) {
        thread.join();
    }
    expect(occluded == 400, "all threads get the same result");
    expect(moc->GetLastStatus() == FOVEAL_CULL_OK, "no call has failed");
    const unsigned int beyond[] = {0, 1, 2};
    const float broken[] = {nan, 0, 0, 1, 0, 0, 0, 1, 0};
    moc->RenderTriangles(broken, beyond, 1, clip_from_model, MaskedOcclusionCulling::BACKFACE_CW,
                         MaskedOcclusionCulling::CLIP_PLANE_ALL, layout);
    expect(moc->GetLastStatus() == FOVEAL_CULL_NOT_FINITE, "a mesh with nan is refused");
    expect(behind() == MaskedOcclusionCulling::OCCLUDED, "and the others still hide");
    MaskedOcclusionCulling::Destroy(moc);
}

const unsigned int quad[] = {0, 1, 2, 0, 2, 3};

// Two workers that run one batch at a time.
struct Workers {
    std::mutex busy;
    template <class Task> void run(std::uint32_t tasks, Task task) {
        const std::lock_guard<std::mutex> lock(busy);
        std::atomic<std::uint32_t> next{0};
        const auto work = [&] {
            for (std::uint32_t i = next++; i < tasks; i = next++) {
                task(i);
            }
        };
        std::thread one(work), two(work);
        one.join();
        two.join();
    }
};

// Tests on the very workers that rasterize.
void tests_on_the_job_system() {
    Workers workers;
    FovealCullJobs jobs{};
    jobs.size = sizeof jobs;
    jobs.count = 2;
    jobs.user = &workers;
    jobs.run = [](void *user, std::uint32_t tasks, FovealCullTask task, void *context) {
        static_cast<Workers *>(user)->run(tasks, [=](std::uint32_t i) { task(context, i); });
    };
    MaskedOcclusionCulling *moc = MaskedOcclusionCulling::Create();
    moc->SetResolution(320, 192);
    moc->SetJobs(&jobs);
    moc->ClearBuffer();
    const float clip[] = {-3, -3, 0, 5, 3, -3, 0, 5, 3, 3, 0, 5, -3, 3, 0, 5};
    moc->RenderTriangles(clip, quad, 2);
    moc->Finish();
    std::atomic<int> occluded{0};
    workers.run(50, [&](std::uint32_t) {
        occluded += moc->TestRect(-0.3f, -0.3f, 0.3f, 0.3f, 8) == MaskedOcclusionCulling::OCCLUDED;
    });
    expect(occluded == 50 && moc->GetLastStatus() == FOVEAL_CULL_OK, "after Finish workers may test");
    MaskedOcclusionCulling::Destroy(moc);
}

// Which meshes are kept, and what is read of them.
void meshes() {
    MaskedOcclusionCulling *moc = MaskedOcclusionCulling::Create();
    moc->SetResolution(320, 192);
    float clip[] = {-3, -3, 0, 5, 3, -3, 0, 5, 3, 3, 0, 5, -3, 3, 0, 5};
    const auto behind = [&] { return moc->TestRect(-0.3f, -0.3f, 0.3f, 0.3f, 8); };
    for (int frame = 0; frame < 200; ++frame) {
        moc->ClearBuffer();
        clip[0] -= 0.001f;
        moc->RenderTriangles(clip, quad, 2);
        expect(behind() == MaskedOcclusionCulling::OCCLUDED, "vertices that change hide");
        expect(moc->GetMeshCount() <= 2, "and are kept for one frame");
    }
    // Memory that is used again, once the shim has been told.
    moc->SetStaticMeshes(true);
    expect(moc->GetMeshCount() == 0, "all is forgotten");
    moc->ClearBuffer();
    moc->RenderTriangles(clip, quad, 2);
    expect(behind() == MaskedOcclusionCulling::OCCLUDED, "a static mesh hides");
    for (int i = 0; i < 16; i += 4) {
        clip[i] += 40;
    }
    moc->SetStaticMeshes(true);
    moc->ClearBuffer();
    moc->RenderTriangles(clip, quad, 2);
    expect(behind() == MaskedOcclusionCulling::VISIBLE, "other content at the same address is another mesh");
    // Only the vertices that indices name are there: the last four of many.
    moc->SetStaticMeshes(false);
    const unsigned int last[] = {1000000, 1000001, 1000002, 1000000, 1000002, 1000003};
    for (int i = 0; i < 16; i += 4) {
        clip[i] -= 40;
    }
    const MaskedOcclusionCulling::VertexLayout layout(16, 4, 12);
    std::vector<float> end(clip, clip + 16);
    const auto before =
        reinterpret_cast<const float *>(reinterpret_cast<std::uintptr_t>(end.data()) - std::uintptr_t{16000000});
    moc->ClearBuffer();
    moc->RenderTriangles(before, last, 2, nullptr, MaskedOcclusionCulling::BACKFACE_CW,
                         MaskedOcclusionCulling::CLIP_PLANE_ALL, layout);
    expect(behind() == MaskedOcclusionCulling::OCCLUDED, "vertices that no index names are not read");
    expect(moc->GetLastStatus() == FOVEAL_CULL_OK, "no call has failed");
    MaskedOcclusionCulling::Destroy(moc);
}

// Several views a frame, each with meshes of its own, and content that changes.
void views() {
    MaskedOcclusionCulling *moc = MaskedOcclusionCulling::Create();
    moc->SetResolution(320, 192);
    const MaskedOcclusionCulling::VertexLayout layout(12, 4, 8);
    float wall[] = {-3, -3, -5, 3, -3, -5, 3, 3, -5, -3, 3, -5};
    const auto draw = [&](float z) {
        moc->ClearBuffer();
        wall[2] = z;
        moc->RenderTriangles(wall, quad, 2, clip_from_model, MaskedOcclusionCulling::BACKFACE_CW,
                             MaskedOcclusionCulling::CLIP_PLANE_ALL, layout);
    };
    const int count = 32;
    for (int frame = 0; frame < 4; ++frame) {
        for (int view = 0; view < count; ++view) {
            draw(-5 - 0.01f * static_cast<float>(view));
        }
        expect(moc->GetMeshCount() == count, "a mesh of one view is kept until that view's next frame");
    }
    for (int frame = 0; frame < 200; ++frame) {
        draw(-6 - 0.01f * static_cast<float>(frame));
    }
    expect(moc->GetMeshCount() <= count + 1, "content that does not come back is forgotten");
    MaskedOcclusionCulling::Destroy(moc);
}

// Random triangles in clip space: what is called occluded is covered, at every pixel centre of the picture.
int random_frames() {
    const int width = 72, height = 52;
    Random r{7};
    int occluded = 0;
    MaskedOcclusionCulling *moc = MaskedOcclusionCulling::Create();
    moc->SetResolution(width, height);
    for (int frame = 0; frame < 150; ++frame) {
        moc->ClearBuffer();
        float v[30][4];
        unsigned int indices[30];
        for (unsigned int i = 0; i < 30; ++i) {
            const double w = r.number(1, 6);
            v[i][0] = static_cast<float>(r.number(-1.6, 1.6) * w);
            v[i][1] = static_cast<float>(r.number(-1.6, 1.6) * w);
            v[i][2] = 0;
            v[i][3] = static_cast<float>(w);
            indices[i] = i;
        }
        moc->RenderTriangles(v[0], indices, 10, nullptr, MaskedOcclusionCulling::BACKFACE_CW);
        for (int query = 0; query < 40; ++query) {
            const double x = r.number(-1, 0.9), y = r.number(-1, 0.9);
            const double w = r.number(4, 9), size = r.number(0.01, 0.3);
            const float rect[] = {static_cast<float>(x), static_cast<float>(y), static_cast<float>(x + size),
                                  static_cast<float>(y + size)};
            const float wmin = static_cast<float>(w);
            if (moc->TestRect(rect[0], rect[1], rect[2], rect[3], wmin) != MaskedOcclusionCulling::OCCLUDED) {
                continue;
            }
            ++occluded;
            for (int py = 0; py < height; ++py) {
                for (int px = 0; px < width; ++px) {
                    const double sx = (px + 0.5) / width * 2 - 1, sy = (py + 0.5) / height * 2 - 1;
                    if (sx < rect[0] || sx > rect[2] || sy < rect[1] || sy > rect[3]) {
                        continue;
                    }
                    bool covered = false;
                    for (int t = 0; t < 30; t += 3) {
                        // Weights of the corners in clip space.
                        double a[3], sum = 0, depth = 0;
                        for (int k = 0; k < 3; ++k) {
                            const float *p = v[t + (k + 1) % 3], *q = v[t + (k + 2) % 3];
                            a[k] = sx * (static_cast<double>(p[1]) * q[3] - static_cast<double>(p[3]) * q[1]) +
                                   sy * (static_cast<double>(p[3]) * q[0] - static_cast<double>(p[0]) * q[3]) +
                                   (static_cast<double>(p[0]) * q[1] - static_cast<double>(p[1]) * q[0]);
                            sum += a[k];
                            depth += a[k] * v[t + k][3];
                        }
                        const double tolerance = 1e-5;
                        covered |= a[0] >= -tolerance && a[1] >= -tolerance && a[2] >= -tolerance && sum > 0 &&
                                   depth / sum <= wmin * (1 + 1e-5);
                    }
                    expect(covered, "what is occluded is covered");
                }
            }
        }
    }
    MaskedOcclusionCulling::Destroy(moc);
    expect(occluded > 100, "enough is occluded");
    return occluded;
}

} // namespace

int main() {
    calls();
    tests_on_the_job_system();
    meshes();
    views();
    const int occluded = random_frames();
    std::printf("shim: %d random rectangles occluded, %d failures\n", occluded, failures);
    return failures == 0 ? 0 : 1;
}
