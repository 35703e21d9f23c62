// Playing a body allocates nothing: every allocation of this program is counted.

#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>

#include "skeleton/runtime/body.h"
#include "tests/skeleton/runtime/live_models.h"

#ifdef __GLIBC__

namespace {
std::atomic<long> allocations_made{0};
}

extern "C" {
void* __libc_malloc(std::size_t size);                           // NOLINT: the C library's own names
void* __libc_memalign(std::size_t alignment, std::size_t size);  // NOLINT

void* malloc(std::size_t size) {
    ++allocations_made;
    return __libc_malloc(size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
    ++allocations_made;
    return __libc_memalign(alignment, size);
}
}

namespace palpate::runtime {
namespace {

TEST(LiveAllocation, PlayingMakesNone) {
    for (skeleton::Model model :
         {skeleton::testing::make_lattice({4, 3, 2}), skeleton::testing::make_full_lattice({4, 3, 2})}) {
        give_skin(model);
        model.effects = {playable_effects()[0], playable_effects()[1], playable_effects()[8]};
        model.dent << 0.5, 0.2, 0.3, 0.1, 0.2, 0.05;
        Body body(model);
        const int pushed = body.touch({30, 10, 14}, 3), dragged = body.touch({30, 0, 5});
        const auto play = [&](double force) {
            body.push(pushed, {0, 0, -force});
            body.drag(dragged, {30, -force, 5}, 0.5);
            body.step_implicit(1e-3);
            body.step_explicit(1e-6, 3);
            body.equilibrium();
            body.skin();
        };
        play(0.5);
        const long before = allocations_made;
        play(1);
        EXPECT_EQ(allocations_made, before);
        EXPECT_GT(body.force(dragged).norm(), 0);
    }
    ASSERT_GT(allocations_made, 100);  // they are counted
}

}  // namespace
}  // namespace palpate::runtime

#endif
