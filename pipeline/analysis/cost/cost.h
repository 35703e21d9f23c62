#pragma once

#include <string>
#include <vector>

#include "pipeline/analysis/cost/work_size.h"

namespace palpate::pipeline {

/// What a stage of a run takes, about: of three runs in four, the seconds are within a factor of two of what was told
/// (tests/bench/cost/RESULTS.md). Where it depends on what is found, `most_seconds` are those of nine runs in ten.
struct StageCost {
    std::string stage;        // as in run.json
    double seconds = 0;       // on the threads that were asked for
    double most_seconds = 0;  // the same as `seconds` where only the size counts
    double gigabytes = 0;     // the most that the process holds
    std::string how = {};     // what solves the equations, and why, in words; empty: nothing large is solved
};

/// `speed`: of a core, against the one on which the rates were measured.
std::vector<StageCost> cost_of_run(const WorkSize& size, int threads, double speed);

}  // namespace palpate::pipeline
