#pragma once

#include <cstdint>
#include <vector>

#include "mesh/core/contact.h"
#include "pipeline/case/probe_options.h"
#include "skeleton/model/model.h"

namespace palpate::pipeline {

/// Where a skeleton itself is probed: one free sphere after the other, those far from each other first, at its centre
/// with 1 N in a direction of its own, drawn by `seed`. [Burion 2008, section IV]
/// @throws InvalidInput when every sphere is held.
std::vector<mesh::Contact> twin_contacts(const skeleton::Model& model, const ProbeOptions& options, std::uint64_t seed);

}  // namespace palpate::pipeline
