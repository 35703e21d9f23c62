#pragma once

#include <array>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "mesh/types.h"
#include "pipeline/forge/wish.h"

namespace palpate::pipeline {

/// The numbers of an effect that were told, over those that are drawn.
class Told {
public:
    Told(const Wish& wish, std::vector<skeleton::KnownParameter> known) : wish_(wish), known_(std::move(known)) {}

    bool has(const std::string& name) const;
    bool has_any(const std::vector<std::string>& names) const;
    double value(const std::string& name, double drawn) const;
    /// Components of a vector: where one is told, those that are not are zero.
    Vec3 vector(const std::array<std::string, 3>& names, const Vec3& drawn) const;
    /// The effect with what is told, and what is drawn (rounded) for the rest, in the order in which its numbers are
    /// known; those that are neither are left out.
    skeleton::Effect effect(const std::vector<std::pair<std::string, double>>& drawn) const;

private:
    Wish wish_;
    std::vector<skeleton::KnownParameter> known_;
};

}  // namespace palpate::pipeline
