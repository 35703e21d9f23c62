#pragma once

#include "identify/diagnosis/fit/explanation.h"

namespace palpate::identify {

/// What planes in 26 directions, at several depths, would do to a body that goes through them: each pushes back the
/// skin that is beyond it, as hard as it takes and never pulling, on the body's own compliance.
///
/// Pressures are told for patches of the skin: at most twelve for a direction, those that come to lie lowest.
class PlaneScan {
public:
    struct Plane {
        Vec3 normal;
        double offset;  // [mm]
        int direction;  // planes of one normal share it
    };

    PlaneScan(const BodyModel& model, const Problem& problem, const ModelSetting& setting,
              const ForwardSolution& forward);

    const std::vector<Plane>& planes() const { return planes_; }
    Eigen::Index width() const { return std::ssize(planes_); }
    /// Forces of 1 N on each patch, along its plane's normal (3s x patches).
    const Eigen::MatrixXd& pressures() const { return pressures_; }
    /// Steps (dofs x planes) that each plane makes in action k; `forces` and `steps`: of the patches (dofs x patches),
    /// steps = J^-1 forces.
    Eigen::MatrixXd pushed_back(int k, const Eigen::MatrixXd& forces, const Eigen::MatrixXd& steps) const;

private:
    struct Direction {
        Vec3 normal;
        Eigen::Index first, count;  // patches
        std::vector<double> offsets;
    };

    std::vector<Direction> directions_;
    std::vector<Plane> planes_;
    Eigen::MatrixXd pressures_;
    std::vector<Eigen::VectorXd> height_;  // where each patch stands along its normal (K of patches) [mm]
};

}  // namespace palpate::identify
