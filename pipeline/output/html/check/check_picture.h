#pragma once

#include <nlohmann/json.hpp>

#include "pipeline/case/subject/subject.h"

namespace palpate::pipeline {

/// What the picture of a check shows, as check_view.js reads it: the surface with what is held and gripped, markers
/// with what looks off, tools and tendons, and of each state the loads and how far markers were read from rest.
/// `preflight`: as in check.json, or null.
nlohmann::json check_picture(const Subject& subject, const nlohmann::json& preflight);

}  // namespace palpate::pipeline
