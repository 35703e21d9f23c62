#pragma once

#include <filesystem>
#include <string>

#include "mesh/formats/deck/deck.h"
#include "mesh/formats/solution/solution.h"

namespace palpate::mesh {

/// Does the name end like one of a solver's results: .frd, .dat, .vtu, .vtp?
bool is_solution_file(const std::filesystem::path& file);

/// Reads CalculiX's results (.frd as text; .dat, whose nodes are the deck's) or a file of ParaView or meshio (.vtu,
/// .vtp) with a point array of displacements: `array`, or when that is empty the one that is called so ("displacement",
/// "U", "disp", ...), or the only one of three components.
/// @throws IoError, InvalidInput naming file, line or array, what is allowed, what to do.
Solution read_solution(const std::filesystem::path& file, const Deck* deck = nullptr, const std::string& array = "");

}  // namespace palpate::mesh
