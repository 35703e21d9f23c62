#pragma once

namespace palpate {

/// Where this checkout and this build lie; in one file of the tests, so that the others are compiled alike everywhere.
extern const char* const samples_folder;
extern const char* const schemas_folder;
extern const char* const program_file;

}  // namespace palpate
