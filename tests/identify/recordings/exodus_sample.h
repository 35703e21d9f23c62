#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::identify {

/// An Exodus file of two nodes, at (1, 2, 3) and (4, 5, 6), in two instants.
struct ExodusSample {
    int dimensions = 3;
    std::vector<double> times{1, 2};
    /// (0.5, 0, 0) in the first instant, (1, 0, 0.25) in the second; without z where there are two dimensions
    std::string displacement = "MODEL_DISPLACEMENT_";
    bool has_sigma = true;         // with gamma, as DICe; -1 for the second node in the second instant
    bool is_one_variable = false;  // coordinates
    bool has_ids = false;          // 17 and 18
};

std::filesystem::path write_exodus(const std::filesystem::path& file, const ExodusSample& sample);

}  // namespace palpate::identify
