#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/case/subject/subject.h"

namespace palpate::bench {

struct BenchBody {
    std::string name;
    std::vector<int> spheres;  // free ones to be measured at; 0: as many as by default
    pipeline::Subject subject;
};

/// Names of all bodies, in the order of the table.
std::vector<std::string> body_names();

/// Limbs, plates and lumps of some 100 mm, and scans and parts from files in `meshes`, 100 mm long; held over the 5 %
/// of their length at the low end of their longest axis, of 0.1 MPa and a Poisson's ratio of 0.45.
/// @throws InvalidInput for another name, IoError where a file is missing.
BenchBody make_bench_body(const std::string& name, const std::filesystem::path& meshes);

}  // namespace palpate::bench
