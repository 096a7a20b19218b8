// Usefulness from C++: an occluder that hides nothing is left out. Ends with 0 if all is well.
#include "expect.hpp"
#include "foveal_cull.hpp"

#include <cstdio>

namespace cull = foveal::cull;

static cull::Affine at(double x, double y, double z) { return {1, 0, 0, 0, 1, 0, 0, 0, 1, x, y, z}; }

static std::uint64_t drawn(const cull::Culler &culler) { return culler.stats().occluder_models_rasterized; }

int main() try {
    // Two walls, and a box behind the left one.
    const cull::Mesh wall = cull::Mesh::box({{-2, -1, -0.1f}, {2, 1, 0.1f}});
    cull::Occluders occluders;
    occluders.add(wall, at(-2.5, 0, -5));
    occluders.add(wall, at(2.5, 0, -5));
    const std::vector<cull::Box> boxes{{{-4.5f, -0.5f, -8.5f}, {-3.5f, 0.5f, -7.5f}}};
    cull::Occludees objects;
    objects.insert(boxes[0]);
    const cull::View view(cull::look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 1.2, 1.78, 0.1));
    for (const bool as_set : {false, true}) {
        cull::Culler culler(320, 180);
        cull::Usefulness usefulness;
        cull::Options options = cull::default_options();
        options.usefulness = usefulness.get();
        for (int frame = 0; frame < 12; ++frame) {
            culler.rasterize(view, occluders, options);
            std::vector<cull::Visibility> results = as_set ? culler.test(objects) : culler.test(boxes);
            if (as_set) {
                usefulness.observe(culler, objects, results);
            } else {
                usefulness.observe(culler, boxes, results);
            }
            expect(results.size() == 1 && results[0] == cull::Visibility::occluded, "the box is hidden");
            usefulness.learn(culler, occluders);
        }
        expect(drawn(culler) == 1, "the right wall is left out");
        expect(culler.stats().clusters_not_useful == 1, "and counted");
        usefulness.forget();
        culler.rasterize(view, occluders, options);
        expect(drawn(culler) == 2, "all is forgotten");
        try {
            usefulness.observe(culler, boxes, {});
            expect(false, "results of another length are refused");
        } catch (const cull::Error &error) {
            expect(error.status() == FOVEAL_CULL_WRONG_LENGTH, "with their code");
        }
    }
    return failures;
} catch (const cull::Error &error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 100;
}
