#include <fmt/format.h>

#include <fstream>

#include "mesh/errors.h"
#include "pipeline/command_line/terminal/outcome.h"

namespace palpate::pipeline::commands {
namespace {

namespace fs = std::filesystem;

/// All that palpate writes says so near its beginning.
bool signed_by_palpate(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::string beginning(4096, '\0');
    in.read(beginning.data(), static_cast<std::streamsize>(beginning.size()));
    return beginning.find("palpate") != std::string::npos;
}

bool made_by_palpate(const fs::path& target) {
    if (!fs::is_directory(target)) return signed_by_palpate(target);
    if (fs::is_empty(target)) return true;
    for (const char* witness : {"run.json", "check.json", "set.yaml", "model.json", "compare.json", "diagnosis.json",
                                "ladder.json", "simulation.pvd"}) {
        if (fs::exists(target / witness)) return signed_by_palpate(target / witness);
    }
    return false;
}

}  // namespace

void refuse_to_overwrite(const fs::path& target, bool force) {
    if (force || !fs::exists(target) || made_by_palpate(target)) return;
    throw InvalidInput(
        fmt::format("{}: exists and was not made by palpate; choose another name with -o, or say --force to replace it",
                    target.string()));
}

}  // namespace palpate::pipeline::commands
