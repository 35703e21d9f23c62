#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace palpate::pipeline {

/// The folder of a run: a lock against a second run in it, and stages that are not run again while nothing that they
/// depend on has changed.
///
/// A stage has a key: the SHA-256 of its settings, of the input files that it reads, and of the keys of the stages
/// before it. run.json records the key, the outputs with their SHA-256, seconds and peak memory of every finished
/// stage; a stage that was killed is not in it.
class RunFolder {
public:
    /// Makes the folder, or takes up one that palpate made. @throws InvalidInput when it holds something else and
    /// `force` is false, or another run works in it.
    RunFolder(std::filesystem::path folder, bool force);
    ~RunFolder();
    RunFolder(const RunFolder&) = delete;
    RunFolder& operator=(const RunFolder&) = delete;

    struct StagePlan {
        std::string name;
        nlohmann::json settings;                     // all that the result depends on, beside files and earlier stages
        std::vector<std::filesystem::path> inputs;   // files outside the run folder
        std::vector<std::string> after;              // earlier stages whose results are read
        std::vector<std::filesystem::path> outputs;  // relative to the run folder
    };
    /// Runs `work` unless the stage is finished with the same key and untouched outputs. Returns whether it ran.
    /// `work` returns figures to keep in run.json.
    bool stage(const StagePlan& plan, const std::function<nlohmann::json()>& work);

    /// Takes back a stage that is no longer asked for, with its outputs (relative to the run folder).
    void drop(const std::string& stage, const std::vector<std::filesystem::path>& outputs);

    const std::filesystem::path& path() const { return folder_; }
    /// What run.json holds: versions, seeds, stages.
    const nlohmann::json& record() const { return record_; }
    void note(const std::string& key, const nlohmann::json& value);

private:
    void save() const;
    std::string key_of(const StagePlan& plan) const;

    std::filesystem::path folder_;
    nlohmann::json record_;
    int lock_ = -1;
};

/// SHA-256 in hexadecimal.
std::string sha256(const std::string& bytes);
std::string sha256_of_file(const std::filesystem::path& file);

}  // namespace palpate::pipeline
