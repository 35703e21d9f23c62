#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::pipeline {

/// What a file or folder of ours holds, in words.
struct Description {
    std::string kind;                // "a run folder"
    std::vector<std::string> lines;  // what is in it
    std::string next;                // a command to type, or ""
};

/// @throws IoError when there is no such file, InvalidInput when it is none of ours, naming what is known.
Description describe(const std::filesystem::path& file);

// One kind each.
Description describe_run(const std::filesystem::path& folder);
Description describe_set(const std::filesystem::path& folder);
Description describe_case(const std::filesystem::path& file);
Description describe_json(const std::filesystem::path& file);    // by its "format"
Description describe_table(const std::filesystem::path& file);   // CSV
Description describe_series(const std::filesystem::path& file);  // PVD
Description describe_poly_data(const std::filesystem::path& file);
Description describe_volume(const std::filesystem::path& file);
Description describe_surface(const std::filesystem::path& file);
Description describe_body(const std::filesystem::path& file);      // tetrahedra, CAD, labels
Description describe_solution(const std::filesystem::path& file);  // of another solver

}  // namespace palpate::pipeline
