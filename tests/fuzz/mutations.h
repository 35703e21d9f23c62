#pragma once

#include <cstdint>
#include <random>
#include <string>

namespace palpate::fuzz {

/// How many inputs a test tries: PALPATE_FUZZ if it is set.
int inputs(int usual);

/// A text or a binary file as somebody, or some fault, may have left it: one to four of a changed byte, a piece lost,
/// said twice or put elsewhere, a cut, a number in the place of another that no reader expects. The seed decides.
std::string mutated(std::string text, std::mt19937_64& random);

}  // namespace palpate::fuzz
