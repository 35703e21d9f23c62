#pragma once

#include "tests/fem/beam.h"
#include "tests/fem/point_potentials.h"

namespace palpate::fem {

/// A bar that is pulled and let go; weak springs [N/mm] keep it from floating away.
struct PulledBar {
    Beam beam{{3, 1, 1}, {3, 1, 1}};
    HyperelasticBody body = beam.body();
    BodySetting setting;

    PulledBar(MaterialLaw law, const Material& material, Effects effects, double springs)
        : setting{law, material, std::move(effects)} {
        setting.effects.points = {std::make_shared<Springs>(ActsOn::support, springs, 0.0)};
    }
    Eigen::VectorXd at(double stress, const MaterialState* before = nullptr,
                       const Eigen::VectorXd* start = nullptr) const {
        return body.equilibrium(setting, beam.pull(stress), {.tolerance = 1e-9}, start, before).u;
    }
    /// Stretches along and across.
    Eigen::Vector2d stretch(const Eigen::VectorXd& u) const {
        Vec3 low = Vec3::Zero(), high = low;
        for (Eigen::Index i = 0; i < beam.mesh.nodes.rows(); ++i) {
            const Vec3 X = beam.mesh.nodes.row(i);
            if (X.norm() < 1e-9) low = u.segment<3>(3 * i);
            if ((X - beam.size).norm() < 1e-9) high = u.segment<3>(3 * i);
        }
        const Vec3 F = Vec3::Ones() + (high - low).cwiseQuotient(beam.size);
        return {F.x(), F.y()};
    }
};

}  // namespace palpate::fem
