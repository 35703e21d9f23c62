#pragma once

#include <Eigen/Core>

namespace palpate::fem {

/// J = d(internal force + effects)/du, factored in some configuration.
class BodyTangent {
public:
    virtual ~BodyTangent() = default;
    /// J^-1 B (3n x p); rows of held nodes are ignored in B and zero in the result. Safe from several threads.
    virtual Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const = 0;
    /// Memory that it takes [GB].
    virtual double gigabytes() const = 0;
};

}  // namespace palpate::fem
