#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "skeleton/runtime/tools/stiff_rows.h"

namespace palpate::runtime {

/// What stiff rows change in a factored matrix A of a body's free spheres: each stiffens it by s along its direction,
/// (A + N^T s N)^-1 = A^-1 - A^-1 N^T (s^-1 + N A^-1 N^T)^-1 N A^-1 [Woodbury], N how the rows' points move along them
/// with the spheres. The columns of A^-1 that it needs, six of each sphere that carries such a point, are kept for as
/// long as A stays.
class StiffenedMatrix {
public:
    using Vector = Eigen::VectorXd;
    /// v <- A^-1 v, in place.
    using Solve = std::function<void(double* v)>;

    StiffenedMatrix() = default;
    /// `block_of`: of each sphere its block in A, -1 where it is held.
    StiffenedMatrix(const std::vector<int>& block_of, Eigen::Index size);

    /// A has changed.
    void forget();
    /// Takes rows up. Allocates where a sphere is for the first time among those that carry their points.
    void take(const StiffRows& stiff, const Solve& solve);
    /// A^-1 v to (A + N^T s N)^-1 v, in place.
    void correct(Vector& v);

private:
    struct Columns {
        Eigen::MatrixXd of;  // A^-1 (6 free x 6)
        bool is_known = false;
        int place = -1;  // among those that carry points
    };
    void find_carrying(const StiffRows& stiff);
    void set_rows(const StiffRows& stiff);

    std::vector<int> block_of_;
    Eigen::Index size_ = 0;
    std::vector<Columns> columns_;  // of each block
    std::vector<int> carrying_;     // blocks
    std::vector<Eigen::Matrix<double, 3, 6>> by_share_;
    Eigen::MatrixXd N_;        // (rows x 6 carrying)
    Eigen::MatrixXd carried_;  // A^-1 there (6 carrying x 6 carrying)
    Eigen::MatrixXd S_;        // s^-1 + N A^-1 N^T, or its Cholesky factor (rows x rows)
    Vector along_, there_;
};

}  // namespace palpate::runtime
