// Receiver masks from C++: what a lamp needs of three crates, and what is refused. Ends with 0 if all is well.
#include "expect.hpp"
#include "foveal_cull.hpp"

#include <cstdio>

namespace cull = foveal::cull;

template <class Call> static void expect_error(FovealCullStatus status, Call call, const char *text) {
    try {
        call();
        expect(false, text);
    } catch (const cull::Error &error) {
        expect(error.status() == status, text);
    }
}

int main() try {
    // A lamp above the ground, which shines down. Of the ground only the part at x = 3 is seen.
    const cull::View lamp(cull::look_at({0, 5, 0}, {0, 0, 0}, {0, 0, -1}, 1.6, 1.0, 0.1));
    const std::vector<cull::Box> ground{{{2, -0.1f, -1}, {4, 0, 1}}, {{-9, -0.1f, -1}, {2, 0, 1}}};
    const std::vector<cull::Visibility> seen{cull::Visibility::visible, cull::Visibility::occluded};
    // A crate between the lamp and that part, one on the other side, and one below the ground.
    const std::vector<cull::Box> crates{{{1.8f, 1, -0.2f}, {2.2f, 1.4f, 0.2f}},
                                        {{-2.2f, 1, -0.2f}, {-1.8f, 1.4f, 0.2f}},
                                        {{2.8f, -2, -0.2f}, {3.2f, -1.6f, 0.2f}}};
    const std::vector<cull::Visibility> all(3), first{cull::Visibility::visible, cull::Visibility::occluded,
                                                      cull::Visibility::occluded};
    cull::ReceiverMask mask(lamp, 512);
    mask.set_reach(3, 0.01);
    expect(mask.empty(), "a new mask is empty");
    mask.receive(ground, seen);
    expect(!mask.empty(), "the ground is in the map");
    auto casters = all;
    mask.cull(crates, casters);
    expect(casters == first, "only the first crate shades what is seen");

    // The same relative to an origin, in a mask that had another map.
    const cull::View aside(cull::look_at({0, 5, 0}, {9, 5, 0}, {0, 1, 0}, 0.1, 1.0, 0.1));
    cull::ReceiverMask other(aside, 64);
    other.receive({}, {});
    other.reset(lamp, 512);
    other.receive(ground.data(), 1, seen.data());
    casters = all;
    const cull::Point origin{0, 0, 0};
    other.cull(crates.data(), 3, casters.data(), origin);
    expect(casters == first, "a mask that is used again is as a new one");
    other.clear();
    expect(other.empty(), "it was emptied");

    expect_error(FOVEAL_CULL_BAD_SIZE, [&] { cull::ReceiverMask none(lamp, 0); }, "a map of no texels");
    expect_error(FOVEAL_CULL_BAD_SIZE, [&] { mask.reset(lamp, 16385); }, "a map of too many texels");
    expect_error(FOVEAL_CULL_NOT_FINITE, [&] { mask.set_reach(-1, 0); }, "a negative reach");
    expect_error(FOVEAL_CULL_WRONG_LENGTH, [&] { mask.receive(ground, {}); }, "no results for receivers");
    std::vector<cull::Visibility> two(2);
    expect_error(FOVEAL_CULL_WRONG_LENGTH, [&] { mask.cull(crates, two); }, "too few results for casters");
    casters = all;
    mask.cull(crates, casters);
    expect(casters == first, "what was refused has changed nothing");
    std::printf("%d failures\n", failures);
    return failures;
} catch (const std::exception &error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
