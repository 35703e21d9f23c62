#include "pipeline/run/batch/workers.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::pipeline {
namespace {

constexpr const char* allowed =
    "allowed: local:N, slurm, slurm:partition=NAME,account=NAME,jobs=N,memory=GB,minutes=N, snakemake:PROFILE";

template <class Number>
std::optional<Number> number_of(const std::string& text) {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

[[noreturn]] void refuse(const std::string& written, const std::string& why) {
    throw InvalidInput(fmt::format("--workers {}: {}; {}", mesh::cited(written), why, allowed));
}

int count_of(const std::string& written, const std::string& key, const std::string& value) {
    constexpr int most = 100000;
    const std::optional<int> count = number_of<int>(value);
    if (!count || *count < 1 || *count > most)
        refuse(written, fmt::format("{} is {}, a whole number from 1 to {} is wanted", key, mesh::cited(value), most));
    return *count;
}

/// A name as clusters have it: nothing that a shell takes for more.
std::string name_of(const std::string& written, const std::string& key, const std::string& value) {
    const auto is_plain = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_' ||
               c == '.';
    };
    if (value.empty() || !std::ranges::all_of(value, is_plain))
        refuse(written, fmt::format("{} is {}, letters, digits, '-', '_' and '.' are wanted", key, mesh::cited(value)));
    return value;
}

void read_slurm_option(const std::string& written, const std::string& option, Workers& workers) {
    const std::size_t sign = option.find('=');
    const std::string key = option.substr(0, sign), value = sign == std::string::npos ? "" : option.substr(sign + 1);
    if (key == "partition") {
        workers.partition = name_of(written, key, value);
    } else if (key == "account") {
        workers.account = name_of(written, key, value);
    } else if (key == "jobs") {
        workers.jobs = count_of(written, key, value);
    } else if (key == "minutes") {
        workers.minutes = count_of(written, key, value);
    } else if (key == "memory") {
        const std::optional<double> memory = number_of<double>(value);
        constexpr double most = 1e5;
        if (!memory || !(*memory > 0) || *memory > most)
            refuse(written,
                   fmt::format("memory is {}, GB from more than 0 to {:g} are wanted", mesh::cited(value), most));
        workers.memory = *memory;
    } else {
        refuse(written, fmt::format("{} is not known", mesh::cited(key)));
    }
}

}  // namespace

Workers parse_workers(const std::string& written) {
    const std::size_t colon = written.find(':');
    const std::string kind = written.substr(0, colon),
                      rest = colon == std::string::npos ? "" : written.substr(colon + 1);
    Workers workers;
    if (kind == "local") {
        workers.jobs = count_of(written, "the number of runs at a time", rest);
    } else if (kind == "slurm") {
        workers.kind = Workers::Kind::slurm;
        workers.jobs = 100;  // more wait in the queue
        for (std::size_t at = 0; !rest.empty() && at <= rest.size();) {
            const std::size_t comma = std::min(rest.find(',', at), rest.size());
            read_slurm_option(written, rest.substr(at, comma - at), workers);
            at = comma + 1;
        }
    } else if (kind == "snakemake") {
        if (rest.empty()) refuse(written, "the profile is missing");
        workers.kind = Workers::Kind::profile;
        workers.profile = rest;
    } else {
        refuse(written, "it is not known");
    }
    return workers;
}

std::vector<std::string> snakemake_arguments(const Workers& workers, int threads) {
    std::vector<std::string> arguments{"--keep-going", "--rerun-incomplete", "--nolock"};
    const auto add = [&](std::initializer_list<std::string> more) { arguments.insert(arguments.end(), more); };
    switch (workers.kind) {
        case Workers::Kind::local:
            add({"--cores", std::to_string(workers.jobs * threads)});
            break;
        case Workers::Kind::profile:
            add({"--profile", workers.profile});
            break;
        case Workers::Kind::slurm: {
            // Snakemake begins it in the folder of the runs, and fills in what is in braces.
            std::string submit =
                "sbatch --parsable --job-name=palpate-{jobid} --output=workflow/%j.out --ntasks=1 "
                "--cpus-per-task={threads} --mem={resources.mem_mb} --time={resources.runtime}";
            if (!workers.partition.empty()) submit += " --partition=" + workers.partition;
            if (!workers.account.empty()) submit += " --account=" + workers.account;
            // A machine that fails is no reason to give a run up; one that fails three times is.
            add({"--cluster", submit, "--cluster-status", "./workflow/slurm_status.sh", "--cluster-cancel", "scancel",
                 "--jobs", std::to_string(workers.jobs), "--restart-times", "2", "--latency-wait", "60"});
            break;
        }
    }
    return arguments;
}

}  // namespace palpate::pipeline
