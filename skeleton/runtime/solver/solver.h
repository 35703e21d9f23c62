#pragma once

#include "skeleton/blocks/block_cholesky.h"
#include "skeleton/links/branches.h"
#include "skeleton/runtime/contacts/contacts.h"
#include "skeleton/runtime/contacts/springs.h"
#include "skeleton/runtime/forces/force_field.h"
#include "skeleton/runtime/solver/learnt_curvature.h"
#include "skeleton/runtime/tools/rig.h"
#include "skeleton/runtime/tools/stiffened_matrix.h"

namespace palpate::runtime {

/// Newton's method on a body: for equilibria, and for implicit steps, which are equilibria of forces and inertia.
/// Allocates nothing once it is made.
class Solver {
public:
    struct Step {
        double h = 0;                // [s]; 0: no inertia, an equilibrium is sought
        double alpha = 0, beta = 0;  // damping [1/s], [s]
        double tolerance = 1e-9;     // how far off a sphere may be, as a share of the mean link length
        int iterations = 50;
        bool reuse = false;       // an old factor, as long as it leads to the answer
        bool extrapolate = true;  // the search starts where the spheres would be without forces, else where they are
    };
    struct Report {
        bool found = false;
        int iterations = 0, factorisations = 0;
        double residual = 0;  // [N]
    };

    Solver(ForceField& field, int contacts, Rig& rig);

    /// From `pose` to the answer, in place. `start`, `velocity`: rows at the beginning of a step.
    Report solve(const Step& step, const std::vector<ContactState*>& contacts, const double* start,
                 const double* velocity, SphereRows& pose);
    /// A contact was set, taken away or has another stiffness.
    void forget_contacts() {
        springs_.forget();
        stiffened_.forget();
    }

    /// Is factorisation so expensive that reuse pays even for large corrections?
    bool factor_is_expensive() const;

    /// Angular frequencies of the stiffest and the softest mode at a pose [1/s]; the softest is 0 where nothing holds
    /// the body. All spheres that move have masses.
    double stiffest_mode(const double* pose);
    double softest_mode(const double* pose);

private:
    using Vector = Eigen::VectorXd;

    /// Net generalized force at a pose (6 free).
    void balance(const Step& step, const std::vector<ContactState*>& contacts, const double* start, const double* pose,
                 Vector& net);
    void predict(const Step& step, const double* start, const double* velocity, double* pose);
    void set_rates(const Step& step, const double* start, const double* pose);
    bool factor(const Step& step, const double* pose, double& shift);
    void assemble(double share, const double* pose);
    void correct(const std::vector<ContactState*>& contacts, const double* pose);
    double step_limit(const double* from) const;
    Eigen::Matrix<double, 6, 1> direction_of(int sphere) const;  // zero for one that is held
    void move(const double* from, double share, double* to) const;
    double largest(const Vector& v, double of_turns) const;
    Vector curvature_times(const std::vector<ForceField::Block>& K, const Vector& v) const;
    Vector mass_times(const double* pose, const Vector& v, bool inverse) const;

    ForceField& field_;
    Rig& rig_;
    double length_ = 1;  // mean of the links [mm]
    std::vector<int> free_, block_of_;
    std::vector<int> coupling_of_;  // of each pair of the field, -1: none
    skeleton::BlockCholesky matrix_;
    skeleton::Branches branches_;
    skeleton::BlockCholesky::Vec6 metric_;
    double stiffest_ = 0;    // entry of the matrix [N/mm]
    bool factored_ = false;  // for:
    double factored_h_ = 0, factored_alpha_ = 0, factored_beta_ = 0;

    SphereRows force_, velocity_, trial_;
    std::vector<Vec3> x_predicted_;
    std::vector<Mat3> R_predicted_;
    std::vector<Mat3> axes_;          // principal axes of inertia at rest, columns
    std::vector<Vec3> spread_;        // second moments of mass along them, half the trace less the inertia [tonne mm^2]
    Vector net_, direction_, there_;  // (6 free)

    Springs springs_;
    StiffRows stiff_;
    StiffenedMatrix stiffened_;
    LimitedMemoryBfgs bfgs_{0};
};

}  // namespace palpate::runtime
