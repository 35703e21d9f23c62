#include "skeleton/runtime/tools/tendons.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "mesh/errors.h"
#include "skeleton/model/attachment/attach.h"

namespace palpate::runtime {

int Tendons::add(const Points& path, double stiffness) {
    if (path.rows() < 2)
        throw InvalidInput(fmt::format("a tendon's path has {} points; it must have 2 or more", path.rows()));
    Tendon tendon;
    tendon.anchor = path.row(0);
    for (Eigen::Index k = 1; k < path.rows(); ++k) {
        const double length = (path.row(k) - path.row(k - 1)).norm();
        if (!(length > 0))
            throw InvalidInput(fmt::format("points {} and {} of a tendon's path are in one place, ({:g}, {:g}, {:g})",
                                           k, k + 1, path(k, 0), path(k, 1), path(k, 2)));
        tendon.rest_length += length;
        tendon.points.emplace_back().assign(skeleton::attach_to_links(model_, path.row(k)), model_.spheres);
    }
    tendon.stiffness = stiffness;
    tendon.along.resize(tendon.points.size());
    tendon.lengths.resize(tendon.points.size());
    tendons_.push_back(std::move(tendon));
    return count() - 1;
}

void Tendons::set(int tendon, Mode mode, double value) {
    tendons_[tendon].mode = mode;
    tendons_[tendon].value = value;
}

bool Tendons::any() const {
    return std::ranges::any_of(tendons_, [](const Tendon& tendon) { return tendon.mode != Mode::free; });
}

void Tendons::place(Tendon& tendon, const double* pose) {
    Vec3 from = tendon.anchor;
    double length = 0;
    for (std::size_t k = 0; k < tendon.points.size(); ++k) {
        tendon.points[k].place(pose);
        const Vec3 way = tendon.points[k].x() - from;
        const double own = way.norm();
        tendon.along[k] = own > 0 ? Vec3(way / own) : Vec3(Vec3::Zero());
        tendon.lengths[k] = own;
        length += own;
        from = tendon.points[k].x();
    }
    const double taut = std::max(0.0, length - tendon.rest_length + tendon.value);
    tendon.tension = tendon.mode == Mode::pulled ? tendon.value : tendon.stiffness * taut;
    if (tendon.mode == Mode::free) tendon.tension = 0;
}

Vec3 Tendons::lengthening(const Tendon& tendon, std::size_t k) {
    const bool is_last = k + 1 == tendon.along.size();
    return is_last ? tendon.along[k] : Vec3(tendon.along[k] - tendon.along[k + 1]);
}

void Tendons::add_forces(const double* pose, double* force) {
    for (Tendon& tendon : tendons_) {
        if (tendon.mode == Mode::free) continue;
        place(tendon, pose);
        if (tendon.tension == 0) continue;
        for (std::size_t k = 0; k < tendon.points.size(); ++k) {
            tendon.points[k].add_force(-tendon.tension * lengthening(tendon, k), force);
        }
    }
}

void Tendons::add_rows(const double* pose, StiffRows& stiff) {
    for (Tendon& tendon : tendons_) {
        if (tendon.mode == Mode::free) continue;
        place(tendon, pose);
        if (tendon.tension == 0) continue;
        add_turning_rows(tendon, stiff);
        if (tendon.mode == Mode::pulled) continue;
        stiff.rows.push_back({tendon.stiffness, tendon.points.size()});
        for (std::size_t k = 0; k < tendon.points.size(); ++k)
            stiff.moves.push_back({&tendon.points[k], lengthening(tendon, k)});
    }
}

// A segment under tension resists turning, by tension over length across it. Without that, links which the tendon
// compresses seem to buckle.
void Tendons::add_turning_rows(const Tendon& tendon, StiffRows& stiff) {
    for (std::size_t k = 0; k < tendon.points.size(); ++k) {
        if (!(tendon.lengths[k] > 0)) continue;
        const Vec3 first = tendon.along[k].unitOrthogonal(), second = tendon.along[k].cross(first);
        for (const Vec3& across : {first, second}) {
            stiff.rows.push_back({tendon.tension / tendon.lengths[k], k > 0 ? 2U : 1U});
            stiff.moves.push_back({&tendon.points[k], across});
            if (k > 0) stiff.moves.push_back({&tendon.points[k - 1], -across});
        }
    }
}

double Tendons::tension(int tendon, const double* pose) {
    place(tendons_[tendon], pose);
    return tendons_[tendon].tension;
}

}  // namespace palpate::runtime
