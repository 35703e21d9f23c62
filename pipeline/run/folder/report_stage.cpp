#include "pipeline/run/folder/report_stage.h"

#include <fmt/format.h>

#include "pipeline/command_line/terminal/console.h"

namespace palpate::pipeline::commands {

void report_stage(const RunFolder& folder, const std::string& stage, bool ran, const std::string& what) {
    const nlohmann::json& record = folder.record()["stages"][stage];
    Console::notice(fmt::format("{:<12} {} ({})", stage, what,
                                ran ? fmt::format("{:.1f} s, {:.0f} MB", record["seconds"].get<double>(),
                                                  record["peak_memory_mb"].get<double>())
                                    : "unchanged"));
}

}  // namespace palpate::pipeline::commands
