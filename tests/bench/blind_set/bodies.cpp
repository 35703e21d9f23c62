#include "blind_set/bodies.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include <cmath>
#include <string>

#include "mesh/formats/surface/read_surface.h"
#include "mesh/text/atomic_file.h"

using namespace palpate;

namespace {

namespace fs = std::filesystem;

/// A box of 2 x 2 x 2 about the origin, made round by r in [0, 1]: 0 a box, 1 a ball. [Nowell's map of cube to sphere]
Vec3 rounded(const Vec3& p, double r) {
    const Vec3 s = p.cwiseAbs2();
    const Vec3 ball(p.x() * std::sqrt(1 - s.y() / 2 - s.z() / 2 + s.y() * s.z() / 3),
                    p.y() * std::sqrt(1 - s.z() / 2 - s.x() / 2 + s.z() * s.x() / 3),
                    p.z() * std::sqrt(1 - s.x() / 2 - s.y() / 2 + s.x() * s.y() / 3));
    return (1 - r) * p + r * ball;
}

/// A box of 2 x 2 x 2 and what is made of it.
struct Shape {
    mesh::Surface box;
    double length = 0, width = 0, height = 0;          // [mm]; it is bent in the plane of length and width
    double round = 0, taper = 0, bend = 0, twist = 0;  // bend, twist [rad]
};

Shape random_solid(std::mt19937_64& random) {
    const auto between = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    const double length = between(50, 150), aspect = std::exp(between(std::log(1.2), std::log(8)));
    const double width = length / aspect, height = width * between(0.6, 1);
    const double round = between(0, 1), taper = between(-0.3, 0.3), bend = between(0, 1.2), twist = between(-0.8, 0.8);
    return {mesh::make_box({-1, -1, -1}, {1, 1, 1}, {24, 12, 12}), length, width, height, round, taper, bend, twist};
}

Shape random_plate(std::mt19937_64& random) {
    const auto between = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    const double length = between(50, 150), thickness = length * std::exp(between(std::log(0.04), std::log(0.1)));
    const double breadth = length / between(1, 2.5), taper = between(-0.3, 0.3), bend = between(0, 1.2);
    return {mesh::make_box({-1, -1, -1}, {1, 1, 1}, {24, 2, 16}), length, thickness, breadth, 0, taper, bend, 0};
}

mesh::Surface body_of(const Shape& shape) {
    const auto& [box, length, width, height, round, taper, bend, twist] = shape;
    mesh::Surface body = box;
    for (Eigen::Index v = 0; v < body.vertices.rows(); ++v) {
        Vec3 p = rounded(body.vertices.row(v), round);
        const double along = (p.x() + 1) / 2;  // from 0 at the held end
        const double scale = 1 - taper * (2 * along - 1);
        const Eigen::Rotation2Dd turn(twist * along);
        const Eigen::Vector2d section = turn * Eigen::Vector2d(p.y() * width / 2 * scale, p.z() * height / 2 * scale);
        // along an arc of that angle
        const double angle = bend * along, radius = bend > 1e-3 ? length / bend : 0;
        const Vec3 axis = bend > 1e-3 ? Vec3(radius * std::sin(angle), radius * (1 - std::cos(angle)), 0)
                                      : Vec3(length * along, 0, 0);
        const Vec3 out(-std::sin(angle), std::cos(angle), 0);
        p = axis + section.x() * out + section.y() * Vec3::UnitZ();
        body.vertices.row(v) = p;
    }
    return body;
}

std::string support(const Vec3& low, const Vec3& high) {
    return fmt::format("  - box: {{min: [{:.4g}, {:.4g}, {:.4g}], max: [{:.4g}, {:.4g}, {:.4g}]}}\n", low.x(), low.y(),
                       low.z(), high.x(), high.y(), high.z());
}

/// Where a plate is held: along one edge, at two corners of it, or along both.
std::string supports_of_plate(const Vec3& low, const Vec3& high, double held, std::mt19937_64& random) {
    const int kind = std::uniform_int_distribution<int>(0, 2)(random);
    const double far = held + low.x(), breadth = high.z() - low.z();
    if (kind == 0) return support(low, {far, high.y(), high.z()});
    if (kind == 1)
        return support(low, {far, high.y(), low.z() + 0.2 * breadth}) +
               support({low.x(), low.y(), high.z() - 0.2 * breadth}, {far, high.y(), high.z()});
    return support(low, {far, high.y(), high.z()}) + support({high.x() - held, low.y(), low.z()}, high);
}

}  // namespace

fs::path write_case(const fs::path& folder, bool thin, std::mt19937_64& random) {
    const auto between = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    fs::create_directories(folder);
    const mesh::Surface body = body_of(thin ? random_plate(random) : random_solid(random));
    mesh::write_surface(folder / "body.stl", body);
    const Vec3 low = body.vertices.colwise().minCoeff().transpose() - Vec3::Ones();
    const Vec3 high = body.vertices.colwise().maxCoeff().transpose() + Vec3::Ones();
    const double held = between(0.05, 0.12) * (high.x() - low.x() - 2) + 1;
    const double poisson = between(0.4, 0.48), young = std::exp(between(std::log(0.03), 0));
    const std::string supports =
        thin ? supports_of_plate(low, high, held, random) : support(low, {low.x() + held, high.y(), high.z()});
    mesh::write_text(folder / "case.yaml",
                     fmt::format("format: palpate-case/1\nmesh: body.stl\nunit: mm\n"
                                 "material: {{young: {:.4g}, poisson: {:.3g}, density: 1050}}\nsupports:\n{}",
                                 young, poisson, supports));
    return folder / "case.yaml";
}
