#include "identify/models/tendon_friction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "identify/models/reference/reference_body.h"
#include "mesh/core/volume_mesh.h"

// A beam that a rubbing tendon bends.

namespace palpate::identify {
namespace {

constexpr double length = 60, width = 4, offset = 1.5, young = 0.4;
constexpr int end = 30;  // the marker at the far end of the axis

/// Held at x = 0, with markers along its axis and a tendon beside it.
class RubbedBeam {
public:
    RubbedBeam() {
        Points path(end + 1, 3);
        for (int k = 0; k <= end; ++k) {
            const double x = length * k / end;
            path.row(k) = Eigen::RowVector3d(x, width / 2, width / 2 + offset);
            markers_.push_back({k, Vec3(x, width / 2, width / 2), {}});
        }
        const Rig rig{{}, {{.name = "tendon", .kind = mesh::TendonActuator{path, false}}}};
        const auto mesh = mesh::to_quadratic(mesh::make_bar(Vec3::Zero(), Vec3(length, width, width), {30, 2, 2}));
        body_ = std::make_unique<ReferenceBody>(
            mesh, std::vector<mesh::Region>{mesh::BoxRegion{Vec3(-1, -1, -1), Vec3(1e-6, 5, 5)}}, markers_,
            ReferenceBodyOptions{.young = young, .poisson = 0.3, .measured_on_mesh = true, .rig = rig});
    }

    /// Where the axis goes.
    Points axis(double tension, double friction, std::vector<double> earlier = {}) const {
        ModelSetting setting{.law = 2, .theta = Eigen::Vector2d(std::log(young), std::log(0.4)), .effects = {}};
        setting.effects.tendon_friction = friction;
        Action action;
        action.settings = {{0, tension, std::move(earlier)}};
        return body_->observe(body_->equilibrium(setting, action), setting);
    }

private:
    std::vector<Marker> markers_;
    std::unique_ptr<ReferenceBody> body_;
};

/// The angle by which the axis has turned where it is half way between two markers [rad].
double turn(const Points& axis, int marker) {
    const Vec3 along = axis.row(marker + 1) - axis.row(marker);
    return std::atan2(along.z(), along.x());
}

TEST(TendonFriction, BendsABeamEverLessTowardsItsEnd) {
    // d(angle)/ds = T d / EI and dT/d(angle) = -mu T: T = T0 / (1 + mu c s), angle = ln(1 + mu c s) / mu, c = T0 d /
    // EI.
    const RubbedBeam beam;
    const double T = 0.1, mu = 0.4, EI = young * std::pow(width, 4) / 12, c = T * offset / EI;
    const Points rubbed = beam.axis(T, mu), smooth = beam.axis(T, 0);
    for (const int marker : {10, 20, 27}) {
        const double s = length * (marker + 0.5) / end;
        const double expected = std::log1p(mu * c * s) / mu;
        // Small strain of 2 %, and the ends of a width, as Tendon.BendsABeamToAnArc: a per cent is left.
        EXPECT_NEAR(turn(rubbed, marker), expected, 0.01 * expected) << marker;
        EXPECT_NEAR(turn(smooth, marker), c * s, 0.01 * c * s) << marker;
    }
    EXPECT_LT(turn(rubbed, 27), 0.87 * turn(smooth, 27));
}

TEST(TendonFriction, KeepsABeamBentOnTheWayBack) {
    const RubbedBeam beam;
    const double up = turn(beam.axis(0.05, 0.4), 27), back = turn(beam.axis(0.05, 0.4, {0.1}), 27);
    const double smooth = turn(beam.axis(0.05, 0, {0.1}), 27);
    EXPECT_GT(back, 1.1 * smooth);
    EXPECT_LT(up, 0.95 * smooth);
}

}  // namespace
}  // namespace palpate::identify
