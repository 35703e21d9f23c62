#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "mesh/formats/deck/deck.h"
#include "mesh/formats/solution/solution.h"

// What the readers of solutions share.

namespace palpate::mesh {

Solution read_frd(const std::filesystem::path& file);
Solution read_dat(const std::filesystem::path& file, const Deck* deck);
Solution read_vtk_solution(const std::filesystem::path& file, const std::string& array);

/// Rows of node numbers. @throws InvalidInput naming the node that stands there twice.
class NodeRows {
public:
    NodeRows(const std::vector<std::int64_t>& numbers, const std::filesystem::path& file);
    /// @throws InvalidInput, `where` names file and line.
    Eigen::Index row(std::int64_t number, const std::string& where) const;

private:
    std::map<std::int64_t, Eigen::Index> rows_;
};

}  // namespace palpate::mesh
