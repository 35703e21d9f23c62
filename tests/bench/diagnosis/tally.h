#pragma once

#include <map>
#include <string>
#include <vector>

#include "diagnosis/truth.h"
#include "identify/diagnosis/material_estimate.h"

namespace palpate::bench {

/// What a bench found over many sets.
class Tally {
public:
    /// `material`: what the best fit comes to.
    void add(const Truth& truth, const identify::Diagnosis& found, Outcome outcome,
             const identify::MaterialEstimate& material);
    void add(const Tally& more);
    void add_failure() { ++counts_[Outcome::inconclusive]; }
    void add_seconds(double taken) { seconds_.push_back(taken); }

    /// Outcomes, false claims, what is named for what (confusion matrix), what is left before and after, the numbers'
    /// errors and how many of them lie inside their 95 % intervals; in Markdown.
    void print() const;

private:
    struct Number {
        double error = 0;  // relative
        double z = 0;      // in standard deviations
    };

    void add_material(const Truth& truth, const identify::MaterialEstimate& material);
    void print_numbers() const;
    void print_reliability() const;

    std::map<Outcome, int> counts_;
    std::vector<double> seconds_;  // of each diagnosis
    int nulls_ = 0, blamed_ = 0;
    std::vector<double> null_evidence_;                        // the largest of each null set, refitted or screened
    std::map<std::string, std::map<std::string, int>> named_;  // for what is hidden
    std::map<std::string, std::vector<Number>> numbers_;
    std::map<std::string, std::vector<double>> before_, after_;  // whitened rms, of what was named rightly
};

std::string joined(const std::vector<std::string>& names);

}  // namespace palpate::bench
