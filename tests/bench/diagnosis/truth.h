#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "identify/diagnosis/diagnose.h"

namespace palpate::bench {

/// What is hidden in a measurement set.
struct Truth {
    std::string set;
    std::vector<std::string> effects;       // empty: nothing is hidden
    double strength = 0;                    // beyond what another stiffness does, over the noise
    std::map<std::string, double> numbers;  // "gravity gx", "material young": as far as they are told
    bool holds(const std::string& effect) const;
};

/// Truths of a folder of sets: truth.csv, and the numbers of truth/<set>.json where there is one.
std::vector<Truth> read_truth(const std::filesystem::path& folder);

enum class Outcome { right, in_part, wrong, inconclusive };
inline constexpr const char* outcome_names[] = {"right", "in part", "WRONG", "inconclusive"};

/// right - all that is hidden is named, or ambiguous with a hidden effect among the first two; nothing hidden:
/// adequate; where the truth was left out of the catalogue: unexplained. in_part - one of several is named, or all that
/// the catalogue holds. wrong - an effect is named that is not there. Else inconclusive.
Outcome judge(const Truth& truth, const identify::Diagnosis& found, const std::vector<std::string>& without);

}  // namespace palpate::bench
