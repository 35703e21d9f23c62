#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "mesh/progress.h"
#include "pipeline/run/batch/workers.h"

namespace palpate::pipeline {

/// Several runs with the same flags, a folder OUTPUT/NAME each, by Snakemake; OUTPUT/NAME.json and NAME.log are what
/// the run says. Its own files are in OUTPUT/workflow.
struct Batch {
    struct Item {
        std::string name;
        std::filesystem::path input;
    };
    std::vector<Item> items;
    std::filesystem::path output;
    std::vector<std::string> flags{};  // of each run
    int threads = 1;                   // of each run
};

/// Named after their files or folders. @throws InvalidInput where two have one name, or one is not there.
std::vector<Batch::Item> batch_items(const std::vector<std::filesystem::path>& inputs);

/// Works them off; those that are done already with these flags and these inputs stay. @throws InvalidInput where there
/// is no Snakemake; SolverFailure where it could not start, with the end of its log.
void work_off(const Batch& batch, const Workers& workers, const Progress& progress);

/// What came of each, as batch.schema.json specifies.
nlohmann::json batch_json(const Batch& batch);
std::string batch_table(const nlohmann::json& batch);

}  // namespace palpate::pipeline
