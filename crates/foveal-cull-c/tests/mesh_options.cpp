// How meshes are baked from C++: each option does what it says. Ends with 0 if all is well.
#include "expect.hpp"
#include "foveal_cull.hpp"

#include <cstdio>

namespace cull = foveal::cull;

using Positions = std::vector<float>;
using Indices = std::vector<std::uint32_t>;

static cull::Mesh bake(const Positions &positions, const Indices &indices, const cull::MeshOptions &options) {
    const std::size_t stride = 3 * sizeof(float);
    return cull::Mesh(positions.data(), positions.size() / 3, stride, indices.data(), indices.size(), options);
}

/// A wall 5 m before the eye. Its front looks away from the eye.
static const Positions wall{-2, -2, -5, 2, -2, -5, 2, 2, -5, -2, 2, -5};
static const Indices back{0, 2, 1, 0, 3, 2};

static cull::Visibility behind(const cull::Occluders &occluders) {
    cull::Culler culler(64, 64);
    culler.rasterize(cull::View(cull::look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 1.0, 1.0, 0.1)), occluders);
    return culler.test(std::vector<cull::Box>{{{-0.5f, -0.5f, -9}, {0.5f, 0.5f, -8}}})[0];
}

static cull::Visibility behind(const cull::Mesh &mesh) {
    cull::Occluders occluders;
    occluders.add(mesh);
    return behind(occluders);
}

/// A cube of 8 x 8 quads on each side, which face outwards.
static void cube(Positions &positions, Indices &indices) {
    for (std::uint32_t side = 0; side < 6; ++side) {
        const std::uint32_t axis = side / 2, first = side * 81, far = side % 2;
        for (std::uint32_t i = 0; i < 81; ++i) {
            float point[3] = {};
            point[axis] = static_cast<float>(far);
            point[(axis + 1) % 3] = static_cast<float>(i % 9) / 8;
            point[(axis + 2) % 3] = static_cast<float>(i / 9) / 8;
            positions.insert(positions.end(), point, point + 3);
        }
        for (std::uint32_t quad = 0; quad < 64; ++quad) {
            const std::uint32_t a = first + quad / 8 * 9 + quad % 8, b = far != 0 ? 1 : 9, c = 10 - b;
            for (const std::uint32_t corner : {a, a + b, a + 10, a, a + 10, a + c}) {
                indices.push_back(corner);
            }
        }
    }
}

int main() try {
    FovealCullMeshSource source{};
    cull::expect_ok(foveal_cull_mesh_source_init(&source));
    const cull::MeshOptions plain;
    expect(plain.two_sided == (source.two_sided != 0), "the default of two_sided is the library's");
    expect(plain.adjacency == (source.adjacency != 0), "that of adjacency is");
    expect(plain.deformable == (source.deformable != 0), "that of deformable is");
    expect(plain.inner_shape == (source.inner_shape != 0), "that of inner_shape is");

    expect(behind(bake(wall, back, plain)) == cull::Visibility::visible, "a wall hides nothing from behind");
    cull::MeshOptions two_sided;
    two_sided.two_sided = true;
    expect(behind(bake(wall, back, two_sided)) == cull::Visibility::occluded, "one of two sides does");

    cull::MeshOptions without_adjacency;
    without_adjacency.adjacency = false;
    const std::size_t with = bake(wall, back, plain).to_bytes().size();
    expect(bake(wall, back, without_adjacency).to_bytes().size() < with, "without adjacency a mesh is smaller");

    for (const bool deformable : {false, true}) {
        cull::MeshOptions options = two_sided;
        options.deformable = deformable;
        cull::Occluders occluders;
        const cull::OccluderId id = occluders.add(bake(wall, back, options));
        Positions aside = wall;
        for (std::size_t i = 0; i < aside.size(); i += 3) {
            aside[i] += 40;
        }
        bool deformed = true;
        try {
            occluders.deform(id, aside.data(), 4, 3 * sizeof(float));
        } catch (const cull::Error &) {
            deformed = false;
        }
        expect(deformed == deformable, "deformable meshes, and only they, get other positions");
        expect((behind(occluders) == cull::Visibility::visible) == deformable, "and hide where these are");
    }

    Positions positions;
    Indices indices;
    cube(positions, indices);
    cull::MeshOptions inner;
    inner.inner_shape = true;
    expect(bake(positions, indices, plain).triangle_count() == 768, "a cube keeps its triangles");
    expect(bake(positions, indices, inner).triangle_count() == 12, "or becomes the box inside of it");
    return failures;
} catch (const cull::Error &error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 100;
}
