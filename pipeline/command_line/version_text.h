#pragma once

#include <string>

namespace palpate::pipeline {

/// What `palpate --version` tells: the version in the first line, then licences and libraries; with --json one object.
std::string version_text(bool json);

}  // namespace palpate::pipeline
