#include "pipeline/run/batch/batch.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <map>
#include <thread>

#include "mesh/errors.h"
#include "mesh/system/interruption.h"
#include "mesh/text/atomic_file.h"
#include "mesh/text/words.h"
#include "pipeline/run/batch/templates.h"
#include "pipeline/run/folder/run_folder.h"

namespace palpate::pipeline {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

fs::path folder_of(const Batch& batch) { return fs::absolute(batch.output) / "workflow"; }

/// A digest of what an input holds, by names, sizes and times: whether it has changed since.
std::string contents_of(const fs::path& input) {
    std::vector<std::string> lines;
    const auto add = [&](const fs::path& file) {
        lines.push_back(fmt::format("{} {} {}", file.string(), fs::file_size(file),
                                    fs::last_write_time(file).time_since_epoch().count()));
    };
    if (fs::is_directory(input)) {
        for (const auto& entry : fs::recursive_directory_iterator(input))
            if (entry.is_regular_file()) add(entry.path());
    } else {
        add(input);
    }
    std::ranges::sort(lines);
    std::string text;
    for (const std::string& line : lines) text += line + "\n";
    return sha256(text);
}

void write_workflow(const Batch& batch, const Workers& workers) {
    json runs = json::object();
    for (const Batch::Item& item : batch.items)
        runs[item.name] = {{"input", fs::absolute(item.input).string()}, {"contents", contents_of(item.input)}};
    const fs::path folder = folder_of(batch);
    mesh::write_text(folder / "config.json", json{{"program", fs::read_symlink("/proc/self/exe").string()},
                                                  {"runs", runs},
                                                  {"flags", batch.flags},
                                                  {"threads", batch.threads},
                                                  {"memory_mb", static_cast<int>(1000 * workers.memory)},
                                                  {"minutes", workers.minutes}}
                                                     .dump(2) +
                                                 "\n");
    mesh::write_text(folder / "Snakefile", std::string(batch_snakefile_text));
    mesh::write_text(folder / "slurm_status.sh", std::string(slurm_status_text));
    fs::permissions(folder / "slurm_status.sh", fs::perms::owner_all);
}

/// A program that runs until it ends, or until an interruption, which it is told.
class Program {
public:
    /// @throws InvalidInput where it is not installed.
    Program(const std::vector<std::string>& words, const fs::path& log) {
        std::vector<char*> arguments;
        arguments.reserve(words.size() + 1);
        for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
        arguments.push_back(nullptr);
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
        posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
        const int error = posix_spawnp(&process_, arguments.front(), &actions, nullptr, arguments.data(), environ);
        posix_spawn_file_actions_destroy(&actions);
        if (error != 0) {
            process_ = -1;
            throw InvalidInput(
                fmt::format("--workers: {} cannot be started ({}); install it, on Debian with apt-get "
                            "install snakemake",
                            words.front(), std::strerror(error)));
        }
    }
    ~Program() {
        if (process_ < 0) return;
        kill(process_, SIGINT);  // Snakemake then cancels its jobs
        waitpid(process_, nullptr, 0);
    }
    Program(const Program&) = delete;
    Program& operator=(const Program&) = delete;

    bool runs() {
        if (process_ < 0) return false;
        const pid_t ended = waitpid(process_, nullptr, WNOHANG);
        if (ended == 0 || (ended < 0 && errno == EINTR)) return true;
        process_ = -1;
        return false;
    }

private:
    pid_t process_ = -1;
};

std::string last_lines(const std::string& text) {
    constexpr std::size_t most = 1000;
    return text.size() <= most ? text : "... " + text.substr(text.size() - most);
}

fs::path result_of(const Batch& batch, const Batch::Item& item) { return batch.output / (item.name + ".json"); }

/// What one run says of itself; of one without an answer, why.
json row_of(const Batch& batch, const Batch::Item& item) {
    json row{{"name", item.name}, {"input", item.input.string()}, {"run", (batch.output / item.name).string()}};
    if (!fs::exists(result_of(batch, item))) {
        const fs::path log = batch.output / (item.name + ".log");
        row["error"] = fs::exists(log) ? "it did not end: see " + log.string()
                                       : "it did not begin: see " + (folder_of(batch) / "snakemake.log").string();
        return row;
    }
    const json told = json::parse(mesh::read_text(result_of(batch, item)));
    if (told.contains("error")) {
        row["error"] = told["error"];
        return row;
    }
    row["report"] = (batch.output / item.name / "report.html").string();  // the run itself began in the folder above
    row["spheres"] = told["spheres"];
    row["rms_mm"] = told["compare"]["error"]["rms_mm"];
    row["relative"] = told["compare"]["error"]["relative"];
    if (const auto held_out = told["compare"].find("held_out");
        held_out != told["compare"].end() && !held_out->is_null())
        row["held_out_relative"] = (*held_out)["relative"];
    if (!told["diagnosis"].is_null()) {
        row["verdict"] = told["diagnosis"]["verdict"];
        row["explanation"] = told["diagnosis"]["explanation"];
    }
    double seconds = 0;
    for (const json& stage : told["stages"]) seconds += stage["seconds"].get<double>();
    row["seconds"] = seconds;
    if (!told["expectations_not_met"].empty()) row["expectations_not_met"] = told["expectations_not_met"];
    return row;
}

}  // namespace

std::vector<Batch::Item> batch_items(const std::vector<fs::path>& inputs) {
    std::map<std::string, fs::path> known;
    std::vector<Batch::Item> items;
    for (const fs::path& input : inputs) {
        if (!fs::exists(input)) throw InvalidInput(fmt::format("{}: there is no such file or folder", input.string()));
        fs::path named = fs::weakly_canonical(input);
        // Every case is called case.yaml, and every set set.yaml: their folders tell them apart.
        if (named.filename() == "case.yaml" || named.filename() == "set.yaml") named = named.parent_path();
        const std::string name = fs::is_directory(named) ? named.filename().string() : named.stem().string();
        if (name.find('/') != std::string::npos || name == "workflow")
            throw InvalidInput(fmt::format("{}: a run cannot be called {}; rename it", input.string(), name));
        const auto [before, is_new] = known.emplace(name, input);
        if (!is_new) {
            throw InvalidInput(
                fmt::format("{} and {} are both called {}; rename one, as each run has a folder of its name",
                            before->second.string(), input.string(), mesh::cited(name)));
        }
        items.push_back({name, input});
    }
    return items;
}

void work_off(const Batch& batch, const Workers& workers, const Progress& progress) {
    write_workflow(batch, workers);
    const fs::path folder = folder_of(batch), log = folder / "snakemake.log";
    std::vector<std::string> words{"snakemake",
                                   "--snakefile",
                                   (folder / "Snakefile").string(),
                                   "--configfile",
                                   (folder / "config.json").string(),
                                   "--directory",
                                   fs::absolute(batch.output).string()};
    const std::vector<std::string> more = snakemake_arguments(workers, batch.threads);
    words.insert(words.end(), more.begin(), more.end());
    const auto done = [&] {
        return std::ranges::count_if(batch.items, [&](const auto& item) { return fs::exists(result_of(batch, item)); });
    };
    {
        Program snakemake(words, log);
        while (snakemake.runs()) {
            Interruption::ask();
            report(progress, fmt::format("{} of {} runs done", done(), batch.items.size()),
                   static_cast<double>(done()) / static_cast<double>(batch.items.size()));
            std::this_thread::sleep_for(std::chrono::milliseconds(200));
        }
    }
    const bool began = std::ranges::any_of(batch.items, [&](const Batch::Item& item) {
        return fs::exists(result_of(batch, item)) || fs::exists(batch.output / (item.name + ".log"));
    });
    if (!began) {
        throw SolverFailure(fmt::format("Snakemake could not start any run. {} ends with:\n{}", log.string(),
                                        last_lines(mesh::read_text(log))));
    }
}

json batch_json(const Batch& batch) {
    json rows = json::array();
    for (const Batch::Item& item : batch.items) rows.push_back(row_of(batch, item));
    return {{"output", batch.output.string()}, {"runs", rows}};
}

std::string batch_table(const json& batch) {
    std::size_t width = 4;
    for (const json& row : batch["runs"]) width = std::max(width, row["name"].get<std::string>().size());
    std::string text = fmt::format("{:<{}}  {:>9}  {:>8}  {:>8}  {:>8}  {}\n", "run", width, "error mm", "relative",
                                   "held out", "seconds", "diagnosis");
    for (const json& row : batch["runs"]) {
        text += fmt::format("{:<{}}  ", row["name"].get<std::string>(), width);
        if (row.contains("error")) {
            text += row["error"].get<std::string>() + "\n";
            continue;
        }
        const auto percent = [&](const char* key) {
            return row.contains(key) ? fmt::format("{:.2f} %", 100 * row[key].get<double>()) : std::string("-");
        };
        std::string diagnosis = row.contains("verdict") ? row["verdict"].get<std::string>() : "-";
        for (std::size_t k = 0; row.contains("explanation") && k < row["explanation"].size(); ++k)
            diagnosis += (k == 0 ? ": " : ", ") + row["explanation"][k].get<std::string>();
        if (row.contains("expectations_not_met")) diagnosis += "; expectations are not met";
        text += fmt::format("{:>9.4g}  {:>8}  {:>8}  {:>8.1f}  {}\n", row["rms_mm"].get<double>(), percent("relative"),
                            percent("held_out_relative"), row["seconds"].get<double>(), diagnosis);
    }
    return text;
}

}  // namespace palpate::pipeline
