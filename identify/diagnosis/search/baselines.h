#pragma once

#include "identify/diagnosis/diagnose_options.h"
#include "mesh/progress.h"

namespace palpate::identify {

/// Numbers that begin a fit under a law without effects: Young's modulus, or what stands for it, scaled so that the
/// linear answers are as large as the measurements' differences to the unloaded state.
Explanation first_guess(const BodyModel& model, const Problem& problem, int law, int threads);

/// A problem fitted under each law of a model, with no effects but those that are known.
class Baselines {
public:
    /// Keeps references to model and options.
    Baselines(const BodyModel& model, const DiagnoseOptions& options)
        : model_(&model), options_(&options), fits_(model.laws().size()) {}

    /// Laws without equilibria are left out, each told in `notes`. @throws SolverFailure when none is left.
    void fit(const Problem& problem, std::vector<std::string>& notes, const Progress& progress);
    /// The same once the readings are others, or their sigmas: under all laws, or only the one that explains most.
    void refit(const Problem& problem, bool best_only = false);

    int laws() const { return static_cast<int>(fits_.size()); }
    const std::optional<Refit>& under(int law) const { return fits_[law]; }
    double evidence(int law) const { return fits_[law] ? fits_[law]->log_evidence : -INFINITY; }
    /// Under the law that explains most.
    const Refit& best() const;
    /// Were laws of large deformation tried, and none found its equilibria?
    bool large_deformation_failed() const { return large_deformation_failed_; }

private:
    Explanation start(const Problem& problem, int law, const Eigen::VectorXd& theta) const;
    Refit fit_under(const Problem& problem, int law, const Refit* neighbour) const;
    std::vector<int> order() const;
    bool could_match(const Problem& problem, int law, const Refit& fit) const;

    const BodyModel* model_;
    const DiagnoseOptions* options_;
    std::vector<std::optional<Refit>> fits_;
    bool large_deformation_failed_ = false;
};

}  // namespace palpate::identify
