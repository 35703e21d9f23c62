#include "skeleton/construction/properties/sections.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace palpate::skeleton {
namespace {

// Of a unit vector: what is left across a link of one that lies along it, whose direction would be rounding's and the
// elements'.
constexpr double lies_along = 1e-3;
// Of what the faces between two cells count: less than this seen along their link is next to nothing.
constexpr double least_seen = 1e-3;
// Cells that meet at their rims, faces that look back: the centroid stays within this of the link's length from its
// ends, and within half of it aside.
constexpr double from_ends = 0.2, aside_at_most = 0.5;
constexpr double widest = 50;  // over the thickness of a strip: no section bends more easily

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

// A unit vector across `along` that is nearest to `vector`, which must not lie along it; its sign does not depend on
// that of `vector`.
Vec3 across_of(const Vec3& along, const Vec3& vector) {
    Vec3 across = vector - vector.dot(along) * along;
    if (!(across.norm() > lies_along)) {
        Eigen::Index least = 0;
        along.cwiseAbs().minCoeff(&least);
        across = Vec3::Unit(least) - along[least] * along;
    }
    across.normalize();
    Eigen::Index most = 0;
    across.cwiseAbs().maxCoeff(&most);
    return across[most] < 0 ? Vec3(-across) : across;
}

// `axis`: from the centre of a, at `origin`, to that of b.
Section section_of(const Integrals& sum, int a, int b, const Vec3& origin, const Vec3& axis) {
    Section s;
    s.a = a;
    s.b = b;
    s.length = axis.norm();
    s.area = sum.area;
    s.dimensions = sum.dimensions / sum.weight;
    const Mat3 across = Mat3::Identity() - axis * axis.transpose() / axis.squaredNorm();
    const Vec3 centroid = sum.first / sum.area;
    const Mat3 moments = across * (sum.second - sum.area * centroid * centroid.transpose()) * across;
    const Eigen::SelfAdjointEigenSolver<Mat3> principal(moments);
    const Vec3 values = principal.eigenvalues();
    const Vec3 along = axis.normalized(), far = across_of(along, principal.eigenvectors().col(2));
    s.axes << along.transpose(), far.transpose(), along.cross(far).transpose();
    Vec3 aside = across * centroid;
    aside *= std::min(1.0, aside_at_most * s.length / std::max(aside.norm(), 1e-300));
    s.centroid = origin + std::clamp(centroid.dot(along) / s.length, from_ends, 1 - from_ends) * axis + aside;
    // Of a strip of this area, w = 50 t: w t^3 / 12.
    const double least = s.area * s.area / (12 * widest);
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
        if (visible.area < least_seen * sum.weight) {
            visible.area = least_seen * sum.weight;
            visible.first = 0.5 * visible.area * axis;
            visible.second = 0.25 * visible.area * axis * axis.transpose();
        }
        all.push_back(section_of(visible, pair.first, pair.second, sites[pair.first].at, axis));
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

namespace {

double torsion_moment(const Section& s) { return 4 * s.moment_1 * s.moment_2 / (s.moment_1 + s.moment_2); }  // ellipse

Vec3 start_of_paper_link(const Section& s, const fem::Material& material) {
    const double E = material.young, mu = material.shear_modulus();

    // In a lump the links are a lattice: a section carries tension and shear alike, kE = kS. Hooke's law would have it
    // so with 2 mu A / L and a volume term apart; these links have none, so E A / L, which gives Young's modulus
    // itself. A shift by s across the link turns both ends by s / L against it:
    //   kF (s / L)^2 = kS s^2 / 2, so kF = kS L^2 / 2.
    if (s.is_lump()) {
        const double kE = E * s.area / s.length;
        return {kE, kE * s.length * s.length / 2, E * (s.moment_1 + s.moment_2) / s.length};
    }

    // A limb is a beam. Pure bending by phi turns the ends by +-phi/2 against the link:
    //   kF ((phi/2)^2 + (phi/2)^2) / 2 = kF phi^2 / 4 = E I phi^2 / (2 L), so kF = 2 E I / L.
    // (Shear alone would ask for 6 E I / L; in a chain of many links bending decides.) A plate bends likewise about
    // its weak axis, and is stiff in its plane by the triangles of its links.
    const double I = s.dimensions < 1.5 ? std::sqrt(s.moment_1 * s.moment_2) : s.moment_2;
    return {E * s.area / s.length, 2 * E * I / s.length, mu * torsion_moment(s) / s.length};
}

Stiffnesses start_of_full_link(const Section& s, const fem::Material& material) {
    const double E = material.young, mu = material.shear_modulus(), L = s.length;
    Stiffnesses k(6);
    if (s.is_lump()) {
        // Hooke's law: 2 mu for all that a section carries, and the volume's term beside.
        k << 2 * mu * s.area / L, 2 * mu * s.moment_1 / L, 2 * mu * (s.moment_1 + s.moment_2) / L,
            2 * mu * s.moment_2 / L, 2 * mu * s.area / L, 2 * mu * s.area / L;
    } else {
        // A beam's segment between rigid ends: what bending gives way is in the shear.
        const double shear = L / (5.0 / 6 * mu * s.area), bending = L * L * L / (12 * E);
        k << E * s.area / L, E * s.moment_1 / L, mu * torsion_moment(s) / L, E * s.moment_2 / L,
            1 / (shear + bending / s.moment_1), 1 / (shear + bending / s.moment_2);
    }
    return k;
}

}  // namespace

Stiffnesses start_stiffness(const Section& section, const fem::Material& material, LinkKind kind) {
    if (is_full(kind)) return start_of_full_link(section, material);
    return start_of_paper_link(section, material);
}

}  // namespace palpate::skeleton
