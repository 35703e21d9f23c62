#include "pipeline/output/csv/posterior.h"

#include <fmt/format.h>

#include <sstream>

#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"

namespace palpate::pipeline {
namespace {

constexpr const char* header = "parameter,link,unit,mean,sd,q025,q50,q975,prior_mean,prior_sd,informed";

}  // namespace

std::string posterior_csv(const std::vector<identify::PosteriorRow>& rows) {
    std::string text = std::string(header) + "\n";
    for (const auto& r : rows) {
        text += fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", r.parameter, r.link < 0 ? "" : std::to_string(r.link),
                            r.unit, r.mean, r.sd, r.q025, r.q50, r.q975, r.prior_mean, r.prior_sd, r.informed ? 1 : 0);
    }
    return text;
}

std::vector<identify::PosteriorRow> read_posterior(const std::filesystem::path& file) {
    std::istringstream lines(mesh::read_text(file));
    std::string line;
    if (!std::getline(lines, line) || line != header) {
        throw InvalidInput(
            fmt::format("{}, line 1: is '{}', a posterior begins with '{}'", file.string(), line, header));
    }
    std::vector<identify::PosteriorRow> rows;
    for (int number = 2; std::getline(lines, line); ++number) {
        std::istringstream cells(line);
        std::vector<std::string> cell;
        for (std::string c; std::getline(cells, c, ',');) cell.push_back(c);
        if (cell.size() != 11) {
            throw InvalidInput(
                fmt::format("{}, line {}: has {} cells, a posterior has 11", file.string(), number, cell.size()));
        }
        try {
            rows.push_back({cell[0], cell[1].empty() ? -1 : std::stoi(cell[1]), cell[2], std::stod(cell[3]),
                            std::stod(cell[4]), std::stod(cell[5]), std::stod(cell[6]), std::stod(cell[7]),
                            std::stod(cell[8]), std::stod(cell[9]), cell[10] == "1"});
        } catch (const std::exception&) {
            throw InvalidInput(
                fmt::format("{}, line {}: holds a cell that is no number: '{}'", file.string(), number, line));
        }
    }
    return rows;
}

}  // namespace palpate::pipeline
