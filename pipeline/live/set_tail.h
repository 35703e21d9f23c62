#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "identify/measurements/measurement_set.h"

namespace palpate::pipeline {

/// The states of a measurement set to which another program appends rows: each once, when it is whole.
///
/// What was appended since is read, up to the last end of a line. A state is whole where it has a load and readings,
/// and a row of another state follows its own, or nothing was appended for a quarter of a second.
class SetTail {
public:
    explicit SetTail(const std::filesystem::path& folder);

    struct News {
        std::vector<identify::LoadState> states;
        std::vector<std::string> faults;  // rows that no reader takes, in its words
    };
    /// What has become whole since the last call. @throws IoError where a table is gone.
    News poll();

private:
    struct Table {
        std::filesystem::path file;
        std::string header;
        int probe = -1, time = -1;  // columns
        char separator = ',';
        std::uintmax_t read = 0;  // bytes
    };
    struct Pending {
        std::string probes, positions;  // rows
    };
    bool read_more(Table& table, std::string Pending::*rows);
    void parse(const Pending& rows, News& news) const;

    std::filesystem::path folder_;
    Table probes_, positions_;
    std::map<identify::StateName, Pending> pending_;
    std::vector<identify::StateName> order_;  // of the pending ones, as they came
    identify::StateName last_;                // of the last row of a reading
    std::chrono::steady_clock::time_point changed_;
};

}  // namespace palpate::pipeline
