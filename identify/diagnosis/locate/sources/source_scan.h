#pragma once

#include <vector>

#include "identify/diagnosis/fit/refit_result.h"
#include "identify/diagnosis/locate/missing_source.h"
#include "identify/diagnosis/locate/reading_adjoints.h"
#include "identify/diagnosis/locate/sources/source_bases.h"
#include "identify/diagnosis/locate/sources/source_evidence.h"

namespace palpate::identify {

/// A term with the evidence of its whole set of alternatives still to be divided among them.
struct Alternative {
    SourceKind kind;
    SourceTerm term = {};
    double log_weight = 0;  // evidence and prior
    double log_fit = 0;     // among places of the same form and law, and prior
    double explained = 0;
    const SourceBasis* basis = nullptr;
    std::size_t place = 0;
};

/// Every source that what a fit leaves of the readings is scored against: each form at each place, under each law.
class SourceScan {
public:
    SourceScan(const BodyModel& model, const Problem& problem, const Refit& fit, int threads);

    /// Those that differ in their place alone stand together.
    std::vector<Alternative> alternatives();

    /// What an alternative alters of the readings, in sigmas of noise (N).
    Eigen::VectorXd altered(const Alternative& one) const;

private:
    Eigen::MatrixXd rows_of(const SourceBasis& basis, const Eigen::VectorXd& strength, Eigen::Index place,
                            Eigen::Index places) const;
    void add(const SourceBasis& basis, SourceLaw law, const Eigen::VectorXd& strength, double log_prior,
             int probe = -1);
    void keep(const SourceBasis& basis, std::size_t place, const SourceEvidence& found, SourceLaw law,
              const Eigen::VectorXd& strength, double log_prior, double gap = 0, int probe = -1);
    void add_one_sided(const SourceBasis& basis, std::size_t place, const Points& towards, double log_prior);
    void add_irregular(const SourceBasis& basis, double log_prior);
    void add_some_states(const SourceBasis& basis, Eigen::Index place, const std::vector<int>& actions,
                         const Eigen::VectorXd& along, double log_prior);
    Eigen::VectorXd in_states(const std::vector<int>& actions, const Eigen::VectorXd& of_actions) const;

    const Problem& problem_;
    std::vector<ReadingEntry> entries_;
    std::vector<SourceBasis> bases_;
    Whitening V_;
    SourceScore score_;
    std::vector<Alternative> found_;
};

}  // namespace palpate::identify
