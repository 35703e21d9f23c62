#include "skeleton/placement/sections.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace palpate::skeleton {
namespace {

constexpr double sliver = 0.05;  // of the mean area

// Integrals over the faces between two cells, projected on the plane across the link: faces that lean against it
// count less and those that look back count negative, so that the teeth of a jagged border cancel.
struct Integrals {
    double area = 0;             // of 1
    Vec3 first = Vec3::Zero();   // of x
    Mat3 second = Mat3::Zero();  // of x x^T
    double weight = 0, dimensions = 0;
};

std::map<std::pair<int, int>, Integrals> integrate(const TetGraph& graph, const Core& core,
                                                   const std::vector<int>& owner, const std::vector<Site>& sites) {
    std::map<std::pair<int, int>, Integrals> all;
    for (int t = 0; t < graph.size(); ++t) {
        for (int c = 0; c < 4; ++c) {
            const int u = graph.neighbors(t, c);
            if (u < 0 || owner[u] <= owner[t]) continue;
            const Site &a = sites[owner[t]], &b = sites[owner[u]];
            if (a.held && b.held) continue;
            Integrals& sum = all[{owner[t], owner[u]}];
            const Vec3 normal = graph.face_area(t, c);
            const double area = normal.dot((b.at - a.at).normalized());
            sum.area += area;
            sum.weight += normal.norm();
            sum.dimensions += normal.norm() * (core.of(t).dimensions + core.of(u).dimensions) / 2;
            // The middles of the edges integrate quadratics over a triangle exactly.
            const auto n = graph.face_nodes(t, c);
            for (int k = 0; k < 3; ++k) {
                const Vec3 x = Vec3((graph.nodes.row(n[k]) + graph.nodes.row(n[(k + 1) % 3])) / 2) - a.at;
                sum.first += area / 3 * x;
                sum.second += area / 3 * x * x.transpose();
            }
        }
    }
    return all;
}

Section section_of(const Integrals& sum, int a, int b, const Vec3& axis) {
    Section s;
    s.a = a;
    s.b = b;
    s.length = axis.norm();
    s.area = sum.area;
    s.dimensions = sum.dimensions / sum.weight;
    const Mat3 across = Mat3::Identity() - axis * axis.transpose() / axis.squaredNorm();
    const Vec3 centroid = sum.first / sum.area;
    const Mat3 moments = across * (sum.second - sum.area * centroid * centroid.transpose()) * across;
    const Vec3 values = Eigen::SelfAdjointEigenSolver<Mat3>(moments, Eigen::EigenvaluesOnly).eigenvalues();
    // No section of this area bends more easily than a strip 50 times as wide as thick.
    const double least = s.area * s.area / (12 * 50);
    s.moment_1 = std::max(values(2), least);
    s.moment_2 = std::max(values(1), least);
    return s;
}

// Roots of the parts that the links chosen so far connect.
struct Parts {
    std::vector<int> parent;
    explicit Parts(std::size_t n) : parent(n) { std::iota(parent.begin(), parent.end(), 0); }
    int root(int i) {
        while (parent[i] != i) i = parent[i] = parent[parent[i]];
        return i;
    }
    bool join(int a, int b) {
        a = root(a);
        b = root(b);
        parent[a] = b;
        return a != b;
    }
};

}  // namespace

std::vector<Section> find_sections(const TetGraph& graph, const Core& core, const std::vector<int>& owner,
                                   const std::vector<Site>& sites) {
    std::vector<Section> all;
    for (const auto& [pair, sum] : integrate(graph, core, owner, sites)) {
        const Vec3 axis = sites[pair.second].at - sites[pair.first].at;
        // Cells may touch behind each other's back: next to nothing is seen along such a link.
        Integrals visible = sum;
        if (visible.area < 1e-3 * sum.weight) {
            visible.area = 1e-3 * sum.weight;
            visible.first.setZero();
            visible.second.setZero();
        }
        all.push_back(section_of(visible, pair.first, pair.second, axis));
    }

    // Largest first: what comes after all are connected may go.
    double mean = 0;
    for (const Section& s : all) mean += s.area / static_cast<double>(all.size());
    std::stable_sort(all.begin(), all.end(), [](const Section& p, const Section& q) { return p.area > q.area; });
    Parts parts(sites.size());
    std::erase_if(all, [&](const Section& s) { return !parts.join(s.a, s.b) && s.area < sliver * mean; });
    std::sort(all.begin(), all.end(),
              [](const Section& p, const Section& q) { return std::pair(p.a, p.b) < std::pair(q.a, q.b); });
    return all;
}

double radius_of_gyration(const Section& s) {
    const double I = s.dimensions < 1.5   ? std::sqrt(s.moment_1 * s.moment_2)
                     : s.dimensions < 2.5 ? s.moment_2
                                          : (s.moment_1 + s.moment_2) / 2;
    return std::sqrt(I / s.area);
}

Vec3 start_stiffness(const Section& s, const fem::Material& material) {
    const double E = material.young, mu = material.shear_modulus();
    const double torsion = 4 * s.moment_1 * s.moment_2 / (s.moment_1 + s.moment_2);  // J of an ellipse

    // A limb is a beam. Pure bending by phi turns the ends by +-phi/2 against the link:
    //   kF ((phi/2)^2 + (phi/2)^2) / 2 = kF phi^2 / 4 = E I phi^2 / (2 L), so kF = 2 E I / L.
    // (Shear alone would ask for 6 E I / L; in a chain of many links bending decides.) A plate bends likewise about
    // its weak axis, and is stiff in its plane by the triangles of its links.
    const double I = s.dimensions < 1.5 ? std::sqrt(s.moment_1 * s.moment_2) : s.moment_2;
    const Vec3 beam(E * s.area / s.length, 2 * E * I / s.length, mu * torsion / s.length);

    // In a lump the links are a lattice: a section carries tension and shear alike, kE = kS. Hooke's law would have it
    // so with 2 mu A / L and a volume term apart; links have none, so E A / L, which gives Young's modulus itself.
    // A shift by s across the link turns both ends by s / L against it:
    //   kF (s / L)^2 = kS s^2 / 2, so kF = kS L^2 / 2.
    const double kE = E * s.area / s.length;
    const Vec3 lattice(kE, kE * s.length * s.length / 2, E * (s.moment_1 + s.moment_2) / s.length);

    return s.dimensions < 2.5 ? beam : lattice;
}

}  // namespace palpate::skeleton
