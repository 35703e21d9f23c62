#pragma once

#include <string>
#include <vector>

namespace palpate::pipeline {

/// Who works off many runs: this machine, a cluster of Slurm's, or what a profile of Snakemake's says.
struct Workers {
    enum class Kind { local, slurm, profile };
    Kind kind = Kind::local;
    int jobs = 1;                        // at a time, >= 1
    double memory = 4;                   // of a job of Slurm's [GB], > 0
    int minutes = 240;                   // that it may take, >= 1
    std::string partition{}, account{};  // of Slurm's; empty: its default
    std::string profile{};               // Snakemake's: a name or a folder
};

/// "local:N", "slurm", "slurm:partition=NAME,account=NAME,jobs=N,memory=GB,minutes=N" or "snakemake:PROFILE".
/// @throws InvalidInput naming what was written and what is allowed.
Workers parse_workers(const std::string& written);

/// What Snakemake is told about them; `threads`: of each run.
std::vector<std::string> snakemake_arguments(const Workers& workers, int threads);

}  // namespace palpate::pipeline
