#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate::identify {

/// A quantity of all nodes over time.
struct NodalField {
    std::string name;
    Eigen::MatrixXd values;  // (nodes x frames); empty where it is no displacement and no sigma
};

/// What an Exodus II file tells of its nodes [Schoof & Yarberry 1994].
struct ExodusNodes {
    Eigen::MatrixXd coordinates;  // (nodes x 2 or 3)
    Eigen::VectorXd times = {};   // (frames)
    std::vector<NodalField> fields = {};
    std::vector<int> ids = {};  // of the nodes; empty: 1, 2, ...
};

/// Of a file of netCDF, classic or on HDF5. A child process reads it: a broken file does no harm.
/// @throws InvalidInput where it is no whole Exodus file.
ExodusNodes read_exodus_nodes(const std::filesystem::path& file);

}  // namespace palpate::identify
