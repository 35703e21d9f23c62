#pragma once

#include <Eigen/SparseCore>

#include "identify/models/body_statics.h"

namespace palpate::identify {

/// Where points of a body stand in a configuration, and how they move with a step of it. All members are const and safe
/// from several threads.
class BodyObservation {
public:
    virtual ~BodyObservation() = default;

    /// Positions of the markers (m x 3) [mm].
    virtual Points observe(const Eigen::VectorXd& q, const ModelSetting& setting) const = 0;
    /// P = d observe / d step (3m x dofs).
    virtual Eigen::SparseMatrix<double> observation(const Eigen::VectorXd& q, const ModelSetting& setting) const = 0;

    /// Where points of the surface (BodyGeometry::skin) stand (s x 3).
    virtual Points skin_positions(const Eigen::VectorXd& q, const ModelSetting& setting) const = 0;
    /// d skin_positions / d step (3s x dofs).
    virtual Eigen::SparseMatrix<double> skin_motion(const Eigen::VectorXd& q, const ModelSetting& setting) const = 0;

    /// The same of points of the material (BodyGeometry::material_points): d where they stand / d step (3n x dofs).
    virtual Eigen::SparseMatrix<double> material_motion() const = 0;

    /// How what is held moves with a rigid motion of the supports about `centre`: translations, then rotation vectors
    /// (dofs x 6); zero at what is free.
    virtual Eigen::MatrixXd support_motion(const Vec3& centre) const = 0;
};

}  // namespace palpate::identify
