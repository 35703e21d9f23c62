#include "skeleton/construction/shape/handles.h"

#include <algorithm>
#include <bit>
#include <deque>
#include <utility>

namespace palpate::skeleton {
namespace {

using Bits = std::uint64_t;

// Inner faces, and the inner edges with the ring of faces round each: a way round an edge goes round no handle.
struct Rings {
    std::vector<std::array<int, 4>> face;      // of each corner (m); -1: outer
    std::vector<std::pair<int, int>> sides;    // of each face: the tetrahedra
    std::vector<std::vector<int>> ring;        // of each inner edge: its faces
    std::vector<std::array<int, 3>> edges_of;  // of each face; -1: an outer edge

    explicit Rings(const TetGraph& graph) : face(graph.size(), {-1, -1, -1, -1}) {
        struct Use {
            std::pair<int, int> edge;
            int face, place;
        };
        std::vector<Use> uses;
        for (int t = 0; t < graph.size(); ++t) {
            for (int c = 0; c < 4; ++c) {
                const int u = graph.neighbors(t, c);
                if (u >= 0 && u < t) continue;
                const int f = u < 0 ? -1 : static_cast<int>(sides.size());
                if (u >= 0) {
                    face[t][c] = f;
                    for (int k = 0; k < 4; ++k) {
                        if (graph.neighbors(u, k) == t) face[u][k] = f;
                    }
                    sides.emplace_back(t, u);
                }
                const auto nodes = graph.face_nodes(t, c);
                for (int k = 0; k < 3; ++k) uses.push_back({std::minmax(nodes[k], nodes[(k + 1) % 3]), f, k});
            }
        }
        std::sort(uses.begin(), uses.end(),
                  [](const Use& p, const Use& q) { return std::pair(p.edge, p.face) < std::pair(q.edge, q.face); });
        edges_of.assign(sides.size(), {-1, -1, -1});
        for (std::size_t i = 0, end = 0; i < uses.size(); i = end) {
            while (end < uses.size() && uses[end].edge == uses[i].edge) ++end;
            if (uses[i].face < 0) continue;
            std::vector<int> faces;
            for (std::size_t k = i; k < end; ++k) {
                faces.push_back(uses[k].face);
                edges_of[uses[k].face][uses[k].place] = static_cast<int>(ring.size());
            }
            ring.push_back(std::move(faces));
        }
    }
};

// Crossings that agree with all rings but some at which loose ends met; `generators`: how many bits were taken.
std::vector<Bits> spread(const Rings& rings, std::vector<char> known, int& generators) {
    std::vector<Bits> crossing(rings.sides.size(), 0);
    std::vector<int> unknown(rings.ring.size());
    std::deque<int> ready;
    for (int e = 0; e < std::ssize(rings.ring); ++e) {
        for (int f : rings.ring[e]) unknown[e] += !known[f];
        if (unknown[e] == 1) ready.push_back(e);
    }
    const auto set = [&](int f, Bits bits) {
        crossing[f] = bits;
        known[f] = 1;
        for (int e : rings.edges_of[f]) {
            if (e >= 0 && --unknown[e] == 1) ready.push_back(e);
        }
    };
    for (int next = 0; next < std::ssize(known);) {
        while (!ready.empty()) {
            const int e = ready.front();
            ready.pop_front();
            if (unknown[e] != 1) continue;
            Bits sum = 0;
            int open = -1;
            for (int f : rings.ring[e]) {
                if (!known[f]) open = f;
                sum ^= known[f] ? crossing[f] : 0;
            }
            set(open, sum);
        }
        while (next < std::ssize(known) && known[next]) ++next;
        if (next < std::ssize(known)) set(next, generators < 64 ? Bits{1} << generators++ : 0);
    }
    return crossing;
}

// Choices of the generators for which every one of the sums vanishes: a basis of them.
std::vector<Bits> null_space(const std::vector<Bits>& sums, int generators) {
    std::vector<Bits> rows;  // reduced, each with a leading bit of its own
    for (Bits sum : sums) {
        for (Bits row : rows) sum = std::min(sum, sum ^ row);
        if (sum == 0) continue;
        for (Bits& row : rows) {
            if ((row & std::bit_floor(sum)) != 0) row ^= sum;
        }
        rows.push_back(sum);
    }
    std::vector<Bits> basis;
    for (int g = 0; g < generators; ++g) {
        const Bits free = Bits{1} << g;
        if (std::any_of(rows.begin(), rows.end(), [&](Bits row) { return std::bit_floor(row) == free; })) continue;
        Bits choice = free;
        for (Bits row : rows) choice |= (row & free) != 0 ? std::bit_floor(row) : 0;
        basis.push_back(choice);
    }
    return basis;
}

}  // namespace

Handles find_handles(const TetGraph& graph) {
    const Rings rings(graph);
    std::vector<char> known(rings.sides.size());
    // Nothing crosses at the faces of a tree through all tetrahedra.
    walk(graph, [&](int tet, int corner) { known[rings.face[tet][corner]] = 1; });
    int generators = 0;
    const std::vector<Bits> crossing = spread(rings, known, generators);
    std::vector<Bits> sums;
    for (const std::vector<int>& ring : rings.ring) {
        Bits sum = 0;
        for (int f : ring) sum ^= crossing[f];
        if (sum != 0) sums.push_back(sum);
    }
    std::sort(sums.begin(), sums.end());
    sums.erase(std::unique(sums.begin(), sums.end()), sums.end());
    const std::vector<Bits> basis = null_space(sums, generators);

    Handles handles;
    handles.count = static_cast<int>(basis.size());
    handles.crossing.assign(graph.size(), {0, 0, 0, 0});
    for (int t = 0; t < graph.size(); ++t) {
        for (int c = 0; c < 4; ++c) {
            if (rings.face[t][c] < 0) continue;
            for (int h = 0; h < handles.count; ++h) {
                const bool odd = std::popcount(crossing[rings.face[t][c]] & basis[h]) % 2 == 1;
                handles.crossing[t][c] |= odd ? Bits{1} << h : 0;
            }
        }
    }
    return handles;
}

}  // namespace palpate::skeleton
