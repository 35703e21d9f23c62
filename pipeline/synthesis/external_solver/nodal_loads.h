#pragma once

#include <string>
#include <vector>

#include "identify/measurements/measurement_set.h"
#include "mesh/formats/deck/deck.h"

namespace palpate::pipeline {

/// The states that a deck's steps are, without readings: step k is probe k, read once. What a step's nodal forces press
/// on hangs together along the surface: each such patch is one contact, with their sum, at their middle, over the disc
/// that spreads as far (radius = sqrt(2) times the rms distance from the middle; 0 for a single node). Gravity of a
/// step is known to act. `unit`: of the deck's lengths [mm]; `notes`: what a contact does not tell of those forces.
/// @throws InvalidInput naming a load that no contact is.
std::vector<identify::LoadState> states_of_steps(const mesh::Deck& deck, double unit, std::vector<std::string>& notes);

/// Where nodes (m x 3) are held, among all nodes of a mesh: their box, up to a thousandth of its size wider, where that
/// holds no other node, else all that lies nearer than `spacing` to one of them.
mesh::Region held_region(const Points& held, const Points& others, double spacing);

}  // namespace palpate::pipeline
