#pragma once

#include <fmt/format.h>

#include <array>
#include <string>
#include <utility>

#include "fem/solver.h"
#include "identify/inference/problem/identify_options.h"
#include "mesh/errors.h"
#include "pipeline/case/body_verdict.h"
#include "pipeline/case/run_diagnosis_options.h"
#include "skeleton/construction/properties/link_kind.h"
#include "skeleton/model/model.h"

namespace palpate::pipeline {

/// Names that users write, and what they stand for.
template <typename Enum, std::size_t N>
using Names = std::array<std::pair<const char*, Enum>, N>;

inline constexpr Names<identify::Scope, 3> scopes{
    {{"uniform", identify::Scope::uniform}, {"zones", identify::Scope::zones}, {"links", identify::Scope::links}}};
inline constexpr Names<identify::Method, 2> methods{
    {{"tempered", identify::Method::tempered}, {"burion2008", identify::Method::burion2008}}};
inline constexpr Names<identify::Domain, 3> domains{{{"by-method", identify::Domain::by_method},
                                                     {"position", identify::Domain::position},
                                                     {"force", identify::Domain::force}}};
inline constexpr Names<identify::LawChoice, 3> law_choices{{{"automatic", identify::LawChoice::automatic},
                                                            {"linear", identify::LawChoice::linear},
                                                            {"large-rotation", identify::LawChoice::large_rotation}}};

inline constexpr Names<fem::Solver, 4> solvers{{{"automatic", fem::Solver::automatic},
                                                {"factor", fem::Solver::factor},
                                                {"multigrid", fem::Solver::multigrid},
                                                {"petsc", fem::Solver::petsc}}};

inline constexpr Names<GravityKnown, 3> gravities{
    {{"automatic", GravityKnown::automatic}, {"earth", GravityKnown::earth}, {"unknown", GravityKnown::unknown}}};

/// Those that are identified: flexion and shear stand for both planes, see skeleton::as_identified.
inline constexpr Names<skeleton::Stiffness, 5> stiffnesses{{{"elongation", skeleton::Stiffness::elongation},
                                                            {"flexion", skeleton::Stiffness::flexion},
                                                            {"torsion", skeleton::Stiffness::torsion},
                                                            {"shear", skeleton::Stiffness::shear},
                                                            {"volume", skeleton::Stiffness::volume}}};
inline constexpr Names<skeleton::LinkKind, 2> link_kinds{
    {{"full", skeleton::LinkKind::full}, {"burion2008", skeleton::LinkKind::burion2008}}};

inline constexpr Names<KeptPieces, 3> kept_pieces{
    {{"automatic", KeptPieces::automatic}, {"largest", KeptPieces::largest}, {"all", KeptPieces::all}}};

/// @throws InvalidInput naming where, what was written and what is allowed.
template <typename Enum, std::size_t N>
Enum parse(const Names<Enum, N>& names, const std::string& written, const std::string& where) {
    std::string allowed;
    for (const auto& [name, value] : names) {
        if (written == name) return value;
        allowed += (allowed.empty() ? "" : ", ") + std::string(name);
    }
    throw InvalidInput(fmt::format("{}: '{}' is not known, allowed is one of {}", where, written, allowed));
}

template <typename Enum, std::size_t N>
std::string name_of(const Names<Enum, N>& names, Enum wanted) {
    for (const auto& [name, value] : names) {
        if (value == wanted) return name;
    }
    return "?";
}

}  // namespace palpate::pipeline
