#include "skeleton/runtime/contacts/contacts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "skeleton/loads/dent.h"
#include "skeleton/model/attachment/attach.h"

namespace palpate::runtime {

namespace {

// A place on the skin: a triangle and the shares of its corners.
struct OnSkin {
    int triangle = 0;
    Vec3 shares = Vec3::Zero();
};

// The point of a triangle nearest to p, by the shares of its corners: that of its plane, or else of its nearest edge.
Vec3 nearest_in(const std::array<Vec3, 3>& x, const Vec3& p) {
    const Vec3 u = x[1] - x[0], v = x[2] - x[0], normal = u.cross(v);
    const double square = normal.squaredNorm();
    if (square > 0) {
        const Vec3 d = p - x[0];
        const double b = d.cross(v).dot(normal) / square, c = u.cross(d).dot(normal) / square;
        if (b >= 0 && c >= 0 && b + c <= 1) return {1 - b - c, b, c};
    }
    Vec3 best = Vec3::UnitX();
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        const Vec3 edge = x[j] - x[i];
        const double length = edge.squaredNorm();
        const double t = length > 0 ? std::clamp((p - x[i]).dot(edge) / length, 0.0, 1.0) : 0;
        const double distance = (p - x[i] - t * edge).squaredNorm();
        if (distance >= least) continue;
        least = distance;
        best.setZero();
        best[i] = 1 - t;
        best[j] = t;
    }
    return best;
}

// The triangle is chosen by the skin as it is shown, in single precision; the place in it by its corners' own.
OnSkin nearest_on(const skeleton::Model& model, const std::vector<float>& skin, const double* pose, const Vec3& p) {
    int best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (int t = 0; t < static_cast<int>(model.surface.triangles.rows()); ++t) {
        std::array<Vec3, 3> x;
        for (int c = 0; c < 3; ++c) {
            x[c] = Eigen::Map<const Eigen::Vector3f>(skin.data() + 3L * model.surface.triangles(t, c)).cast<double>();
        }
        const Vec3 shares = nearest_in(x, p);
        const double distance = (shares[0] * x[0] + shares[1] * x[1] + shares[2] * x[2] - p).squaredNorm();
        if (distance >= least) continue;
        least = distance;
        best = t;
    }
    std::array<Vec3, 3> x;
    for (int c = 0; c < 3; ++c) {
        RuntimePoint corner;
        corner.assign(model.skin[model.surface.triangles(best, c)], model.spheres);
        corner.place(pose);
        x[c] = corner.x();
    }
    return {best, nearest_in(x, p)};
}

struct PatchPoint {
    OnSkin on;
    Vec3 at = Vec3::Zero();  // at rest
    double area = 0;         // [mm^2]
};

Vec3 rest_of(const skeleton::Model& model, const OnSkin& on) {
    Vec3 sum = Vec3::Zero();
    for (int c = 0; c < 3; ++c) {
        sum += on.shares[c] * model.surface.vertices.row(model.surface.triangles(on.triangle, c)).transpose();
    }
    return sum;
}

// Centres of equal pieces of the skin's triangles that lie within a radius at rest; pieces are at most a third of it.
std::vector<PatchPoint> patch_round(const skeleton::Model& model, const Vec3& centre, double radius) {
    std::vector<PatchPoint> patch;
    for (int t = 0; t < static_cast<int>(model.surface.triangles.rows()); ++t) {
        const auto corner = [&](int c) -> Vec3 {
            return model.surface.vertices.row(model.surface.triangles(t, c)).transpose();
        };
        const Vec3 u = corner(1) - corner(0), v = corner(2) - corner(0);
        const double longest = std::max({u.norm(), v.norm(), (u - v).norm()});
        if ((corner(0) + (u + v) / 3 - centre).norm() > radius + longest) continue;
        const int n = std::clamp(static_cast<int>(std::ceil(3 * longest / radius)), 1, 64);
        const double area = u.cross(v).norm() / (2.0 * n * n);
        const auto add = [&](double i, double j) {
            PatchPoint point{{t, {1 - (i + j) / n, i / n, j / n}}, Vec3::Zero(), area};
            point.at = rest_of(model, point.on);
            if ((point.at - centre).norm() <= radius) patch.push_back(point);
        };
        for (int i = 0; i < n; ++i) {
            for (int j = 0; j < n - i; ++j) {
                add(i + 1.0 / 3, j + 1.0 / 3);                     // upright piece
                if (j < n - i - 1) add(i + 2.0 / 3, j + 2.0 / 3);  // its upside-down neighbour
            }
        }
    }
    return patch;
}

// The kernels of the dent where the skin lies near enough to the patch.
void find_dented(const skeleton::Model& model, skeleton::PatchForce press, ContactState& contact) {
    // A unit force along the normal alone, and amplitudes of one kernel each, tell its mean over the patch.
    press.normal = Vec3::UnitX();
    press.force = Vec3::UnitX();
    const double reach = 6 * press.radius;
    for (Eigen::Index v = 0; v < model.surface.vertices.rows(); ++v) {
        const Points at = model.surface.vertices.row(v);
        if ((at.row(0).transpose() - press.patch.front().first).norm() > reach) continue;
        const Eigen::MatrixXd motions = skeleton::dent_motions({{}, {press}}, at);
        const Eigen::Vector3f kernels = Vec3(motions(0, 0), motions(0, 2), motions(0, 4)).cast<float>();
        if (kernels.isZero(0)) continue;
        contact.dented.push_back(static_cast<int>(v));
        contact.kernels.push_back(kernels);
    }
}

}  // namespace

void place_contact(const skeleton::Model& model, const std::vector<float>& skin, const double* pose, const Vec3& point,
                   double radius, ContactState& contact) {
    const OnSkin nearest = nearest_on(model, skin, pose, point);
    const Vec3 centre = rest_of(model, nearest);
    std::vector<PatchPoint> patch;
    if (radius > 0) patch = patch_round(model, centre, radius);
    const bool pressed = !patch.empty();
    if (!pressed) patch.push_back({nearest, centre, 1});

    double area = 0;
    for (const PatchPoint& one : patch) area += one.area;
    std::vector<std::pair<double, const skeleton::Attachment*>> parts;
    skeleton::PatchForce press{Vec3::Zero(), Vec3::Zero(), radius, {}};
    for (const PatchPoint& one : patch) {
        press.patch.emplace_back(one.at, one.area / area);
        for (int c = 0; c < 3; ++c) {
            parts.emplace_back(one.on.shares[c] * one.area / area,
                               &model.skin[model.surface.triangles(one.on.triangle, c)]);
        }
    }
    contact.used = contact.creeps = true;
    contact.mode = ContactState::Mode::nothing;
    contact.gain = 1;
    contact.crept.setZero();
    contact.lagged_force.setZero();
    contact.at.assign(skeleton::blend(parts), model.spheres);
    contact.dented.clear();
    contact.kernels.clear();
    if (!pressed || model.dent.isZero(0)) return;
    contact.normal = mesh::mean_normal(model.surface, centre, radius);
    find_dented(model, press, contact);
}

void add_dent(const skeleton::Model& model, const ContactState& contact, std::vector<float>& skin) {
    if (contact.dented.empty()) return;
    const Vec3 f = contact.effective_force(), along = f.dot(contact.normal) * contact.normal, across = f - along;
    Eigen::Matrix3f motions;  // a column a reach
    for (int R = 0; R < 3; ++R) {
        motions.col(R) = (model.dent[2 * R] * along + model.dent[2 * R + 1] * across).cast<float>();
    }
    for (std::size_t i = 0; i < contact.dented.size(); ++i) {
        Eigen::Map<Eigen::Vector3f>(skin.data() + 3L * contact.dented[i]) += motions * contact.kernels[i];
    }
}

}  // namespace palpate::runtime
