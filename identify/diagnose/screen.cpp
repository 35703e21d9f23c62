#include "identify/diagnose/screen.h"

#include <cmath>

namespace palpate::identify {
namespace {

/// All columns side by side, with their prior precisions.
struct Stack {
    Eigen::MatrixXd columns;
    Eigen::VectorXd precisions;

    void add(const Eigen::MatrixXd& more, const Eigen::VectorXd& more_precisions) {
        Eigen::MatrixXd wider(more.rows(), columns.cols() + more.cols());
        Eigen::VectorXd longer(precisions.size() + more_precisions.size());
        if (columns.cols() > 0) wider.leftCols(columns.cols()) = columns;
        wider.rightCols(more.cols()) = more;
        longer << precisions, more_precisions;
        columns = std::move(wider);
        precisions = std::move(longer);
    }
};

}  // namespace

std::vector<Screened> screen_effects(const BodyModel& model, const Problem& problem, const Refit& fit,
                                     const std::vector<std::shared_ptr<const Effect>>& effects, int threads) {
    // The fit's own numbers join the nuisances: d about their priors' means.
    Stack always;
    always.add(fit.columns, fit.prior_sd.cwiseAbs2().cwiseInverse());
    always.add(fit.nuisances.columns, fit.nuisances.precisions);
    const Eigen::VectorXd off_mean = fit.explanation.all() - fit.prior_mean;
    const Eigen::VectorXd d = fit.error + fit.columns * off_mean;
    const Whitening V(fit.V->weights(), always.columns, always.precisions);

    std::vector<Screened> result;
    for (const auto& effect : effects) {
        if (effect->numbers(model, problem).empty()) continue;
        const Effect::ScreenColumns b = effect->screen_columns(model, problem, fit.explanation, fit.played, threads);
        const ScreenResult said = screen(V, d, b.columns, b.prior_sd);

        // What is left once it is in, contacts as they are told: the fit's numbers and the effect's move, no nuisance.
        Stack with = always;
        with.add(b.columns, b.prior_sd.cwiseAbs2().cwiseInverse());
        const Eigen::VectorXd moved = Whitening(fit.V->weights(), with.columns, with.precisions)
                                          .nuisances(d)
                                          .cwiseQuotient(with.precisions.cwiseSqrt());
        const Eigen::VectorXd left = fit.error - fit.columns * (moved.head(off_mean.size()) - off_mean) -
                                     b.columns * moved.tail(b.columns.cols());
        result.push_back({effect, said.log_bayes_factor, said.keep,
                          std::sqrt(left.cwiseProduct(problem.sigma).squaredNorm() / static_cast<double>(d.size())),
                          effect->start_after_screen(b, said.value)});
    }
    return result;
}

}  // namespace palpate::identify
