#pragma once

#include <optional>
#include <vector>

#include "identify/diagnosis/locate/reading_adjoints.h"
#include "identify/diagnosis/locate/sources/source_places.h"

namespace palpate::identify {

/// Sources of one form in all places: what the readings feel of a unit of each of p numbers there.
struct SourceBasis {
    SourceKind kind = SourceKind::body_force;
    SourceForm form = SourceForm::force;
    int width = 1;  // numbers of a place (p)
    bool one_sided = false;
    /// The law that its columns hold already; absent: any that is alike at all places.
    std::optional<SourceLaw> law = {};
    std::vector<SourcePlace> places = {};
    Eigen::MatrixXd columns = {};  // of the entries, over sigma (entries x places p)
    Eigen::MatrixXd motions = {};  // of places on the skin in each action (actions x 3 places) [mm]; empty: elsewhere
};

/// All forms that the model and the problem allow, at the configurations of a fit.
std::vector<SourceBasis> source_bases(const BodyModel& model, const Problem& problem, const Refit& fit,
                                      const std::vector<ReadingEntry>& entries, int threads);

}  // namespace palpate::identify
