#include "fem/linear_algebra/multigrid/multigrid.h"

#include "fem/linear_algebra/multigrid/coarsest_level.h"
#include "fem/linear_algebra/multigrid/level.h"

namespace palpate::fem {

namespace {

constexpr double least_coarsening = 0.8;  // of nodes, from level to level; what does not coarsen is solved for directly

}  // namespace

struct Multigrid::Impl {
    BlockMatrix<3, 3> A;
    Level<3> finest;
    std::vector<Level<6>> coarser;
    CoarseSolver coarse_solver;
    double complexity;

    /// x from 0, by smoothing, the coarser levels' correction, and smoothing.
    template <int b>
    void cycle(const Level<b>& level, std::size_t next, MultiVector& f, MultiVector& x) const {
        x.setZero(f.rows(), f.cols());
        level.smoother.smooth(level.A, x, f, true);
        MultiVector coarse_f(6 * Eigen::Index(level.restriction.rows()), f.cols()),
            correction(coarse_f.rows(), f.cols());
        multiply(level.restriction, f, coarse_f);
        if (next < coarser.size()) {
            cycle(coarser[next], next + 1, coarse_f, correction);
        } else {
            coarse_solver.solve(coarse_f, correction);
        }
        MultiVector corrected(x.rows(), x.cols());
        multiply(level.prolongation, correction, corrected);
        x += corrected;
        multiply(level.A, corrected, f, Join::subtract);
        level.smoother.smooth(level.A, x, f, false);
    }
};

Multigrid::Multigrid(BlockMatrix<3, 3> A, const RigidModes& modes, const MultigridOptions& options) {
    double strength = options.strength;
    const auto entries = static_cast<double>(9 * A.blocks());
    int finer_nodes = A.rows();
    Coarsened<3> finest = coarsen(A, modes, strength);
    BlockMatrix<6, 6> coarse = std::move(finest.A);
    RigidModes coarse_modes = std::move(finest.modes);
    double all_entries = entries + static_cast<double>(36 * coarse.blocks());
    std::vector<Level<6>> coarser;
    while (coarse.rows() > options.coarsest_nodes && coarse.rows() < least_coarsening * finer_nodes) {
        finer_nodes = coarse.rows();
        Coarsened<6> next = coarsen(coarse, coarse_modes, strength /= 2);
        coarser.push_back(std::move(next.level));
        coarse = std::move(next.A);
        coarse_modes = std::move(next.modes);
        all_entries += static_cast<double>(36 * coarse.blocks());
    }
    impl_ = std::make_unique<Impl>(
        Impl{std::move(A), std::move(finest.level), std::move(coarser), CoarseSolver(coarse), all_entries / entries});
}

Multigrid::~Multigrid() = default;
Multigrid::Multigrid(Multigrid&&) noexcept = default;

void Multigrid::apply(MultiVector& f, MultiVector& x) const { impl_->cycle(impl_->finest, 0, f, x); }
const BlockMatrix<3, 3>& Multigrid::matrix() const { return impl_->A; }
int Multigrid::levels() const { return static_cast<int>(impl_->coarser.size()) + 2; }
double Multigrid::complexity() const { return impl_->complexity; }

}  // namespace palpate::fem
