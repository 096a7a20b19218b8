// The headers after macros that other headers define (windows.h, Unreal Engine), and with failures that
// return although they must not: what is handed out then is zero, not memory that was never written. Calls
// with boxes and ids in braces mean one thing. Ends with 0 if all is well.
#include <algorithm>
#include <array>
#include <atomic>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#define small char
#define near
#define far
#define min(a, b) (((a) < (b)) ? (a) : (b))
#define max(a, b) (((a) > (b)) ? (a) : (b))
#define check(expression) static_assert(false, "a macro of the engine")
#define require(assertion, label) static_assert(false, "a macro of the system")
#define verify(expression) static_assert(false, "a macro of the engine")

static int failures = 0;
#define FOVEAL_CULL_FAIL(status, text) (++failures, static_cast<void>(status), static_cast<void>(text))

#include "foveal_cull.hpp"
#include "moc_shim.hpp"

int main() {
    const double flat[16] = {};
    const foveal::cull::Eye eye = foveal::cull::eye_from_matrix(flat, FOVEAL_CULL_DEPTH_ZERO_TO_ONE);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const foveal::cull::Eye other = foveal::cull::look_at({nan, 0, 0}, {0, 0, -1}, {0, 1, 0}, 1.0, 1.0, 0.1);
    const foveal::cull::Eye none{};
    const bool zero = std::memcmp(&eye, &none, sizeof eye) == 0 && std::memcmp(&other, &none, sizeof other) == 0;
    foveal::cull::Mesh solid = foveal::cull::Mesh::box({{0, 0, 0}, {1, 1, 1}});
    const foveal::cull::Mesh moved = std::move(solid);
    const bool bytes = solid.to_bytes().empty() && !moved.to_bytes().empty();
    MaskedOcclusionCulling *moc = MaskedOcclusionCulling::Create();
    MaskedOcclusionCulling::Destroy(moc);
    foveal::cull::Occludees carts;
    const foveal::cull::OccludeeId cart = carts.insert({{0, 0, 0}, {1, 1, 1}});
    carts.move(cart, {{0, 0, 0}, {2, 2, 2}});
    const auto others = carts.insert_all({{{0, 0, 0}, {1, 1, 1}}, {{3, 0, 0}, {4, 1, 1}}});
    const auto last = carts.insert_all({{{5, 0, 0}, {6, 1, 1}}});
    carts.move_all({cart, others[0]}, {{{0, 0, 0}, {3, 3, 3}}, {{0, 0, 0}, {4, 4, 4}}});
    const bool boxes = carts.count() == 4 && carts.bounds(cart).max[0] == 3 && carts.bounds(last[0]).max[0] == 6;
    carts.remove_all({cart, others[1]});
    carts.remove({others[0].set, others[0].occludee});
    foveal::cull::Occluders occluders;
    const foveal::cull::OccluderId solid_id = occluders.add(moved);
    occluders.move(solid_id, {1, 0, 0, 0, 1, 0, 0, 0, 1, 5, 0, 0});
    occluders.move_all({solid_id}, {{1, 0, 0, 0, 1, 0, 0, 0, 1, 7, 0, 0}});
    const bool rest = carts.count() == 1 && carts.contains(last[0]);
    std::printf("%d failures, zero: %d, bytes: %d, boxes: %d, rest: %d\n", failures, zero, bytes, boxes, rest);
    return failures == 3 && zero && bytes && boxes && rest ? 0 : 1;
}
