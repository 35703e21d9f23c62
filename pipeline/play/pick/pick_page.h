#pragma once

#include <string>

#include "pipeline/case/subject/subject.h"

namespace palpate::pipeline {

/// One self-contained page on which somebody chooses by mouse where a body is held, pressed and read, and which hands
/// out the files that say so: case.yaml and a measurement set to fill in, or what to change in the case or the set that
/// `subject` was read from.
std::string pick_page(const Subject& subject);

}  // namespace palpate::pipeline
