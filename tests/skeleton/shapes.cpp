#include "tests/skeleton/shapes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <stdexcept>

#include "mesh/meshing/remesh.h"
#include "mesh/meshing/repair_surface.h"
#include "mesh/meshing/tetrahedralise.h"

namespace palpate::skeleton {
namespace {

using Level = std::function<double(const Vec3&)>;

double capsule(const Vec3& p, const Vec3& a, const Vec3& b, double radius) {
    const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0., 1.);
    return (p - a - t * (b - a)).norm() - radius;
}

double torus(const Vec3& p, double ring, double radius) {
    return std::hypot(std::hypot(p.x(), p.y()) - ring, p.z()) - radius;
}

// The union of two bodies with a fillet of about `k`. [Quilez, smooth minimum]
double united(double a, double b, double k) {
    const double h = std::max(k - std::abs(a - b), 0.) / k;
    return std::min(a, b) - h * h * k / 4;
}

// Moves the vertices to even distances along the level.
void even_out(const Level& f, double step, mesh::Surface& surface) {
    for (int round = 0; round < 10; ++round) {
        Points sum = Points::Zero(surface.vertices.rows(), 3);
        Eigen::VectorXd count = Eigen::VectorXd::Zero(surface.vertices.rows());
        for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
            for (int c = 0; c < 3; ++c) {
                const int a = surface.triangles(t, c);
                sum.row(a) += surface.vertices.row(surface.triangles(t, (c + 1) % 3));
                count(a) += 1;
            }
        }
        for (Eigen::Index v = 0; v < count.size(); ++v) {
            Vec3 x = sum.row(v) / count(v);
            for (int newton = 0; newton < 3; ++newton) {
                Vec3 slope;
                for (int k = 0; k < 3; ++k) {
                    const Vec3 h = 1e-4 * step * Vec3::Unit(k);
                    slope(k) = (f(x + h) - f(x - h)) / (2e-4 * step);
                }
                x -= f(x) / slope.squaredNorm() * slope;
            }
            surface.vertices.row(v) = x;
        }
    }
}

// A vertex on the edge from the inside to the outside, and never so close to an end that triangles vanish.
Vec3 crossing(const Level& f, const Vec3& inside, const Vec3& outside) {
    double low = 0, high = 1;
    for (int i = 0; i < 40; ++i) {
        const double t = (low + high) / 2;
        (f(inside + t * (outside - inside)) < 0 ? low : high) = t;
    }
    return inside + std::clamp(low, 0.15, 0.85) * (outside - inside);
}

}  // namespace

mesh::Surface level_surface(const Level& f, const mesh::Box& box, double step) {
    const Eigen::Vector3i cells = (box.extent() / step).array().ceil().cast<int>();
    const mesh::VolumeMesh grid = mesh::make_bar(box.min, box.max, cells);
    std::vector<double> value(grid.nodes.rows());
    for (Eigen::Index n = 0; n < grid.nodes.rows(); ++n) value[n] = f(grid.nodes.row(n));

    std::map<std::pair<int, int>, int> index;
    std::vector<Vec3> vertices;
    std::vector<std::array<int, 3>> triangles;
    const auto vertex = [&](int in, int out) {
        const auto [found, fresh] = index.try_emplace({in, out}, std::ssize(vertices));
        if (fresh) vertices.push_back(crossing(f, grid.nodes.row(in), grid.nodes.row(out)));
        return found->second;
    };
    const auto add = [&](int a, int b, int c, const Vec3& outward) {
        const Vec3 normal = (vertices[b] - vertices[a]).cross(vertices[c] - vertices[a]);
        if (normal.dot(outward) < 0) std::swap(b, c);
        triangles.push_back({a, b, c});
    };
    for (Eigen::Index t = 0; t < grid.tetrahedra.rows(); ++t) {
        std::vector<int> in, out;
        for (int c = 0; c < 4; ++c) (value[grid.tetrahedra(t, c)] < 0 ? in : out).push_back(grid.tetrahedra(t, c));
        if (in.empty() || out.empty()) continue;
        Vec3 outward = Vec3::Zero();
        for (int n : out) outward += grid.nodes.row(n).transpose() / std::ssize(out);
        for (int n : in) outward -= grid.nodes.row(n).transpose() / std::ssize(in);
        if (in.size() == 2) {
            const int a = vertex(in[0], out[0]), b = vertex(in[0], out[1]);
            const int c = vertex(in[1], out[1]), d = vertex(in[1], out[0]);
            add(a, b, c, outward);
            add(a, c, d, outward);
        } else if (in.size() == 1) {
            add(vertex(in[0], out[0]), vertex(in[0], out[1]), vertex(in[0], out[2]), outward);
        } else {
            add(vertex(in[0], out[0]), vertex(in[1], out[0]), vertex(in[2], out[0]), outward);
        }
    }
    mesh::Surface surface;
    surface.vertices.resize(std::ssize(vertices), 3);
    surface.triangles.resize(std::ssize(triangles), 3);
    for (std::size_t i = 0; i < vertices.size(); ++i) surface.vertices.row(static_cast<Eigen::Index>(i)) = vertices[i];
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        for (int c = 0; c < 3; ++c) surface.triangles(static_cast<Eigen::Index>(i), c) = triangles[i][c];
    }
    even_out(f, step, surface);
    return surface;
}

std::vector<Shape> all_shapes() {
    const auto box = [](const Vec3& size, const Eigen::Vector3i& quads) {
        return mesh::make_box(-size / 2, size / 2, quads);
    };
    const auto level = [](const Vec3& reach, double step, const Level& f) {
        // Off the middle, so that no corner of the grid lies on a plane of symmetry.
        const Vec3 shift(0.37, 0.23, 0.11);
        return level_surface(f, {-reach - shift, reach + shift}, step);
    };
    Mat3 across = Mat3::Identity();
    across.col(0).setZero();
    std::vector<Shape> shapes;
    shapes.push_back({"bar", box({160, 16, 16}, {40, 4, 4}), 0, 1, true, across});
    shapes.push_back({"plate", box({100, 80, 6}, {25, 20, 2}), 0, -1, true, across});
    shapes.push_back({"sheet", box({100, 80, 2}, {25, 20, 1}), 0, -1, true, across});
    shapes.push_back({"cube", box({60, 60, 60}, {12, 12, 12}), 0, -1, false, across});
    shapes.push_back(
        {"ellipsoid",
         level({52, 37, 27}, 3, [](const Vec3& p) { return p.cwiseQuotient(Vec3(50, 35, 25)).norm() - 1; }), 0, -1,
         false, across});
    shapes.push_back(
        {"torus", level({45, 45, 10}, 2, [](const Vec3& p) { return torus(p, 35, 8); }), 1, 0, true, across});
    shapes.push_back({"double torus",
                      level({65, 38, 9}, 2,
                            [](const Vec3& p) {
                                const Vec3 c(27, 0, 0);
                                return united(torus(p - c, 25, 7), torus(p + c, 25, 7), 5);
                            }),
                      2, 0, true, across});
    shapes.push_back({"tee",
                      level({62, 48, 10}, 2,
                            [](const Vec3& p) {
                                return united(capsule(p, Vec3(-50, 0, 0), Vec3(50, 0, 0), 8),
                                              capsule(p, Vec3(50, -38, 0), Vec3(50, 38, 0), 8), 6);
                            }),
                      0, 2, true, across});
    shapes.push_back(
        {"wye",
         level({60, 62, 10}, 2,
               [](const Vec3& p) {
                   const Vec3 o = Vec3::Zero();
                   return united(capsule(p, o, Vec3(-50, 0, 0), 7),
                                 united(capsule(p, o, Vec3(45, 45, 0), 6), capsule(p, o, Vec3(45, -45, 0), 6), 4), 4);
               }),
         0, 2, true, across});
    shapes.push_back({"hollow ball", level({42, 42, 42}, 3, [](const Vec3& p) { return std::abs(p.norm() - 35) - 5; }),
                      0, -1, false, across});
    return shapes;
}

Shape shape(const std::string& name) {
    const std::vector<Shape> shapes = all_shapes();
    const auto found = std::find_if(shapes.begin(), shapes.end(), [&](const Shape& s) { return s.name == name; });
    if (found == shapes.end()) throw std::invalid_argument("no shape " + name);
    return *found;
}

Meshed meshed(const mesh::Surface& surface, double share) {
    const mesh::Surface repaired = mesh::repair_surface(surface).surface;
    const double edge = share * mesh::bounding_box(repaired.vertices).longest_side();
    Meshed body;
    body.surface = mesh::remesh(repaired, {.edge_length = edge, .volume_change = 0.05});
    body.volume = mesh::tetrahedralise(body.surface, {.edge_length = edge});
    return body;
}

mesh::PlaneRegion end_clamp(const mesh::Surface& surface, double share) {
    const mesh::Box box = mesh::bounding_box(surface.vertices);
    Eigen::Index axis = 0;
    const double longest = box.extent().maxCoeff(&axis);
    return {box.min, Vec3::Unit(axis), share * longest};
}

mesh::Surface Motion::operator()(mesh::Surface surface) const {
    surface.vertices = (surface.vertices * turn.transpose()).rowwise() + shift.transpose();
    return surface;
}

mesh::PlaneRegion Motion::operator()(mesh::PlaneRegion region) const {
    return {turn * region.point + shift, turn * region.normal, region.within};
}

Motion some_motion() {
    return {Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix(), Vec3(300, -40, 11)};
}

mesh::Surface noisy(mesh::Surface surface, double share, unsigned seed) {
    std::mt19937_64 engine(seed);
    std::normal_distribution<double> normal(0, share * mesh::bounding_box(surface.vertices).longest_side());
    const Points normals = mesh::vertex_normals(surface);
    for (Eigen::Index v = 0; v < normals.rows(); ++v) surface.vertices.row(v) += normal(engine) * normals.row(v);
    return surface;
}

mesh::Surface shuffled(const mesh::Surface& surface, unsigned seed) {
    std::mt19937_64 engine(seed);
    std::vector<Eigen::Index> vertices(surface.vertices.rows()), triangles(surface.triangles.rows());
    std::iota(vertices.begin(), vertices.end(), 0);
    std::iota(triangles.begin(), triangles.end(), 0);
    std::shuffle(vertices.begin(), vertices.end(), engine);
    std::shuffle(triangles.begin(), triangles.end(), engine);
    mesh::Surface result = surface;
    for (std::size_t v = 0; v < vertices.size(); ++v) result.vertices.row(vertices[v]) = surface.vertices.row(v);
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        for (int c = 0; c < 3; ++c)
            result.triangles(triangles[t], c) = static_cast<int>(vertices[surface.triangles(t, c)]);
    }
    return result;
}

}  // namespace palpate::skeleton
