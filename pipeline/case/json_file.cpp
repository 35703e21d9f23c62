#include "pipeline/case/json_file.h"

#include <fmt/format.h>

#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"

namespace palpate::pipeline {

nlohmann::json json_of_file(const std::filesystem::path& file) {
    try {
        return nlohmann::json::parse(mesh::read_text(file));
    } catch (const nlohmann::json::exception& e) {
        throw InvalidInput(fmt::format("{}: is no JSON: {}", file.string(), e.what()));
    }
}

}  // namespace palpate::pipeline
