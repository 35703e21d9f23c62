#include "skeleton/construction/shape/handles.h"

#include <gtest/gtest.h>

#include "tests/skeleton/shapes.h"

namespace palpate::skeleton {
namespace {

TetGraph graph_of(const std::string& name) { return make_tet_graph(meshed(shape(name).surface).volume, 1); }

TEST(Handles, AreAsManyAsTheBodyHasHoles) {
    EXPECT_EQ(find_handles(graph_of("plate")).count, 0);
    EXPECT_EQ(find_handles(graph_of("torus")).count, 1);
    EXPECT_EQ(find_handles(graph_of("double torus")).count, 2);
    // A cavity is no handle: every way round it can be drawn together.
    EXPECT_EQ(find_handles(graph_of("hollow ball")).count, 0);
}

TEST(Handles, CrossingsAreTheSameFromBothSides) {
    const TetGraph graph = graph_of("torus");
    const Handles handles = find_handles(graph);
    int crossed = 0;
    for (int t = 0; t < graph.size(); ++t) {
        for (int c = 0; c < 4; ++c) {
            const int u = graph.neighbors(t, c);
            if (u < 0) {
                EXPECT_EQ(handles.crossing[t][c], 0u);
                continue;
            }
            crossed += handles.crossing[t][c] != 0;
            for (int k = 0; k < 4; ++k) {
                if (graph.neighbors(u, k) != t) continue;
                EXPECT_EQ(handles.crossing[u][k], handles.crossing[t][c]);
            }
        }
    }
    EXPECT_GT(crossed, 0);
}

}  // namespace
}  // namespace palpate::skeleton
