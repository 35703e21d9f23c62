#include "tests/places.h"

namespace palpate {

const char* const samples_folder = PALPATE_SAMPLES;
const char* const schemas_folder = PALPATE_SCHEMAS;
const char* const program_file = PALPATE_PROGRAM;

}  // namespace palpate
