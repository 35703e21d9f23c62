#include "pipeline/analysis/quality/graph.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <numeric>

#include "mesh/geometry/surface_tree.h"
#include "mesh/topology/shells.h"

namespace palpate::pipeline {
namespace {

using Ring = std::vector<int>;  // of links, ascending

/// Rank of rings as chains modulo 2, by elimination: each kept one has a last link of its own.
class RingSpace {
public:
    explicit RingSpace(std::size_t links) : kept_(links) {}

    int rank() const { return rank_; }

    void add(Ring ring) {
        while (!ring.empty()) {
            Ring& pivot = kept_[ring.back()];
            if (pivot.empty()) {
                pivot = std::move(ring);
                ++rank_;
                return;
            }
            Ring sum;
            std::ranges::set_symmetric_difference(ring, pivot, std::back_inserter(sum));
            ring = std::move(sum);
        }
    }

private:
    std::vector<Ring> kept_;
    int rank_ = 0;
};

/// The skeleton's links as a graph.
class Graph {
public:
    explicit Graph(const skeleton::Model& model) : model_(model), next_(model.spheres.size()) {
        for (int l = 0; l < static_cast<int>(model.links.size()); ++l) {
            next_[model.links[l].a][model.links[l].b] = l;
            next_[model.links[l].b][model.links[l].a] = l;
        }
    }

    int parts() const {
        std::vector<int> part(next_.size());
        std::iota(part.begin(), part.end(), 0);
        const auto root = [&](int s) {
            while (part[s] != s) s = part[s];
            return s;
        };
        for (const skeleton::Link& link : model_.links) part[root(link.a)] = root(link.b);
        int count = 0;
        for (int s = 0; s < static_cast<int>(part.size()); ++s) count += part[s] == s;
        return count;
    }

    /// Loops that are left once short rings within the body are filled; `loops`: all.
    int handles(int loops, const mesh::SurfaceTree& body) const {
        RingSpace filled(model_.links.size());
        const auto is_inside = [&](std::initializer_list<int> spheres) {
            Vec3 middle = Vec3::Zero();
            for (const int s : spheres) middle += model_.spheres[s].center / static_cast<double>(spheres.size());
            return body.inside(middle);
        };
        for (int a = 0; a < size(); ++a) {
            for (const auto& [b, ab] : next_[a]) {
                for (const auto& [c, bc] : next_[b]) {
                    if (a < b && b < c && next_[a].contains(c) && is_inside({a, b, c})) {
                        filled.add(ring({ab, bc, next_[a].at(c)}));
                    }
                }
            }
        }
        // Rings a b c d of four links without a diagonal, once each: a is the least, b < d.
        for (int a = 0; a < size() && filled.rank() < loops; ++a) {
            for (auto b = next_[a].upper_bound(a); b != next_[a].end(); ++b) {
                for (auto d = std::next(b); d != next_[a].end(); ++d) {
                    if (next_[b->first].contains(d->first)) continue;
                    for (const auto& [c, bc] : next_[b->first]) {
                        if (c <= a || next_[a].contains(c) || !next_[d->first].contains(c)) continue;
                        if (!is_inside({a, b->first, c, d->first})) continue;
                        filled.add(ring({b->second, bc, next_[d->first].at(c), d->second}));
                    }
                }
            }
        }
        return loops - filled.rank();
    }

private:
    int size() const { return static_cast<int>(next_.size()); }
    static Ring ring(Ring links) {
        std::ranges::sort(links);
        return links;
    }

    const skeleton::Model& model_;
    std::vector<std::map<int, int>> next_;  // of each sphere: its neighbours, and the links there
};

/// Of a connected closed surface: V - E + F = 2 - 2 genus, with E = 3 F / 2.
int genus(const mesh::Surface& surface) {
    const Eigen::Index euler = surface.vertices.rows() - surface.triangles.rows() / 2;
    return static_cast<int>(1 - euler / 2);
}

bool leaves(const mesh::SurfaceTree& body, const Vec3& from, const Vec3& to) {
    constexpr int points = 16;  // along the link: a gap shorter than a sixteenth of it may go unseen
    for (int i = 1; i < points; ++i) {
        if (!body.inside(from + (to - from) * i / points)) return true;
    }
    return false;
}

}  // namespace

GraphQuality graph_quality(const skeleton::Model& model) {
    GraphQuality quality;
    for (const mesh::Shell& shell : mesh::find_shells(model.surface)) {
        quality.body_parts += !shell.is_cavity();
        quality.body_handles += genus(shell.surface);
    }
    const Graph graph(model);
    const mesh::SurfaceTree body(model.surface);
    quality.parts = graph.parts();
    quality.loops = static_cast<int>(model.links.size()) - static_cast<int>(model.spheres.size()) + quality.parts;
    quality.handles = graph.handles(quality.loops, body);
    quality.links_outside = static_cast<int>(std::ranges::count_if(model.links, [&](const skeleton::Link& link) {
        return leaves(body, model.spheres[link.a].center, model.spheres[link.b].center);
    }));
    return quality;
}

}  // namespace palpate::pipeline
