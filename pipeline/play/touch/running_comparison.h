#pragma once

#include <vector>

#include "identify/loading/readings.h"
#include "identify/loading/reduced_load.h"

namespace palpate::pipeline {

/// Incremental evaluation of a model on a set, state by state; the total equals identify::compare.
class RunningComparison {
public:
    /// @throws InvalidInput where the model cannot be played.
    RunningComparison(skeleton::Model model, const identify::MeasurementSet& set);

    /// States with labelled readings.
    int count() const { return static_cast<int>(readings_.size()); }
    const identify::StateReadings& readings(int r) const { return readings_[r]; }

    struct Error {
        double squares = 0;        // of all measured coordinates [mm^2]
        int coordinates = 0;       // that were measured
        bool is_full_load = true;  // the model bears the whole load
    };
    /// Plays state r. States are to be judged in their order where the material remembers. @throws SolverFailure.
    Error evaluate(int r);

    /// The equilibrium of a state that was judged.
    const identify::ReducedLoadEquilibrium& played(int r) const { return played_[r]; }
    const skeleton::Model& model() const { return model_; }

private:
    skeleton::Model model_;
    std::vector<identify::StateReadings> readings_;
    skeleton::StaticsSolver solver_;
    Eigen::VectorXd k_;
    std::vector<skeleton::Equilibrium> so_far_;
    std::vector<identify::ReducedLoadEquilibrium> played_;
};

}  // namespace palpate::pipeline
