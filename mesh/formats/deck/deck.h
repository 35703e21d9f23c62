#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "mesh/formats/deck/cells.h"

namespace palpate::mesh {

/// What acts at the end of a step.
struct DeckStep {
    std::map<std::int64_t, Vec3> forces;  // of nodes [N]
    std::optional<Vec3> gravity;          // [length/s^2]
    std::vector<std::string> others;      // loads that are not understood: "*DLOAD, body.inp, line 12"
};

/// What an input file of Abaqus or CalculiX says, in its own units, as far as it is about a body and its loads.
struct Deck {
    std::filesystem::path file;
    Cells cells;
    std::set<std::int64_t> held;          // nodes whose displacements are all zero
    std::set<std::int64_t> held_in_part;  // only some of them, or not at zero
    std::vector<DeckStep> steps;
    std::optional<double> young, poisson, density;  // of its only material, when it is linear and isotropic
    std::vector<std::filesystem::path> files;       // that were read: it, and what it includes
    std::vector<std::string> notes;                 // what was left out, in words
};

/// Reads *NODE, *ELEMENT, *NSET, *ELSET, *BOUNDARY, *STEP, *CLOAD, *DLOAD, *MATERIAL and *INCLUDE (of files in the same
/// folder); other keywords are skipped, shells and beams left out. Loads stay in force in later steps unless these say
/// OP=NEW. @throws IoError, InvalidInput naming file and line, the value, what is allowed, what to do.
Deck read_deck(const std::filesystem::path& file);

}  // namespace palpate::mesh
