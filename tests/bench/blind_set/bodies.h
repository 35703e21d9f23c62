#pragma once

#include <filesystem>
#include <random>

// Bodies drawn at random.
//
// They are boxes made round, tapered, bent and twisted, 50 to 150 mm long and up to eight times as long as thick,
// held at one end, of .03 to 1 MPa and a Poisson's ratio of .4 to .48. `thin`: plates and curved shells in their place,
// of 4 to 10 % of their length in thickness, held along one edge, at two corners of it, or along both.

/// A case of such a body, written to a folder of its own.
std::filesystem::path write_case(const std::filesystem::path& folder, bool thin, std::mt19937_64& random);
