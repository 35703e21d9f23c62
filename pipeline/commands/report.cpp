#include "pipeline/report/report.h"

#include <fmt/format.h>

#include "pipeline/commands/common.h"

namespace palpate::pipeline::commands {

Outcome report(const ReportOptions& options, const Common& common) {
    const std::filesystem::path page = options.output.empty() ? options.run / "report.html" : options.output;
    refuse_to_overwrite(page, common.force);
    write_report(options.run, page);
    return {.text = fmt::format("Report: {}\nOpen it in a browser; it needs no network.\n", page.string()),
            .json = {{"report", page.string()}}};
}

}  // namespace palpate::pipeline::commands
