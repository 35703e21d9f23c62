#pragma once

#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "fem/large_deformation/body/loaded_body.h"

namespace palpate::fem {

/// Points that tools may touch, in Newton's method with a factor that serves for several steps.
///
/// Touches are stiff, and come and go: a step that knows only of those that there are now has to end where the next
/// point comes in touch. So a step leads to the least value of a quadratic model of the body in which touches are
/// one-sided and their gaps linear. The factor holds some points to the tool on both sides. With H its inverse, r the
/// net force with these held, b the gaps after the step H r, and n_i the normals of the points i that touch though they
/// are not held, or part though they are,
///   s = H (r + sum_i n_i lambda_i),   (n^T H n + diag(+-1/k)) lambda = -b,
/// with + where they touch and - where they part. Which points these are is found by active sets. [Hintermueller, Ito &
/// Kunisch 2002]
class ActiveSet {
public:
    using Points = std::vector<NearPoint>;
    /// H times several forces (unknowns x m).
    using Inverse = std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)>;

    /// Forgets where the last step led, and takes a factor made elsewhere to hold what touches now.
    void start(const Points& points);
    /// Makes the factor of K, to which the points that touch now have given their part, hold those that the last step
    /// led to, if there was one.
    void hold(const LoadedBody& body, const Unknowns& unknowns, const Points& points, LowerMatrix& K);
    /// Net force on the unknowns with the held points held on both sides.
    Eigen::VectorXd held_force(const LoadedBody& body, const Unknowns& unknowns, const Eigen::VectorXd& r,
                               const Points& points) const;
    /// The step from there. @param r the net force on the unknowns
    Eigen::VectorXd step(const LoadedBody& body, const Unknowns& unknowns, const Eigen::VectorXd& r,
                         const Points& points, const Inverse& H);
    /// How many forces the last step applied H to.
    std::size_t solutions() const { return solutions_; }

private:
    std::map<int, Vec3> held_;                     // by id, their normals where the factor was made
    std::optional<std::vector<int>> led_to_ = {};  // ids, ascending
    std::size_t solutions_ = 0;
};

}  // namespace palpate::fem
