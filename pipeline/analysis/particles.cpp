#include "pipeline/analysis/particles.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <sstream>

#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"

namespace palpate::pipeline {
namespace {

std::vector<std::string> cells_of(const std::string& line) {
    std::vector<std::string> cells;
    std::istringstream in(line);
    for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
    return cells;
}

}  // namespace

std::string particles_csv(const identify::IdentifyResult& found) {
    std::string text = "weight";
    for (const identify::PosteriorRow& row : found.posterior) text += "," + row.parameter;
    text += "\n";
    if (found.history.empty()) return text;
    const identify::FilterStep& last = found.history.back();
    for (Eigen::Index i = 0; i < last.particles.rows(); ++i) {
        text += fmt::format("{:.6g}", std::exp(last.log_weights[i]));
        for (const double value : last.particles.row(i)) text += fmt::format(",{:.6g}", value);
        text += "\n";
    }
    return text;
}

ParticleSet read_particles(const std::filesystem::path& file) {
    std::istringstream lines(mesh::read_text(file));
    std::string line;
    std::getline(lines, line);
    std::vector<std::string> header = cells_of(line);
    if (header.size() < 2 || header.front() != "weight") {
        throw InvalidInput(fmt::format(
            "{}, line 1: is '{:.80}', a file of particles begins with 'weight' and the names of its parameters",
            file.string(), line));
    }
    std::vector<std::vector<double>> rows;
    for (int number = 2; std::getline(lines, line); ++number) {
        const std::vector<std::string> cells = cells_of(line);
        if (cells.size() != header.size()) {
            throw InvalidInput(fmt::format("{}, line {}: has {} cells, its header {}", file.string(), number,
                                           cells.size(), header.size()));
        }
        std::vector<double>& row = rows.emplace_back();
        for (const std::string& cell : cells) {
            char* end = nullptr;
            const double value = std::strtod(cell.c_str(), &end);  // which takes weights of next to nothing, 1e-310
            if (cell.empty() || *end != '\0' || !(value >= 0) || std::isinf(value)) {
                throw InvalidInput(fmt::format("{}, line {}: '{}' is no weight or stiffness; it must be 0 or more",
                                               file.string(), number, cell));
            }
            row.push_back(value);
        }
    }
    ParticleSet set;
    set.parameters.assign(header.begin() + 1, header.end());
    const auto n = static_cast<Eigen::Index>(rows.size()), P = static_cast<Eigen::Index>(set.parameters.size());
    set.weights.resize(n);
    set.stiffness.resize(n, P);
    for (Eigen::Index i = 0; i < n; ++i) {
        const auto& row = rows[static_cast<std::size_t>(i)];
        set.weights[i] = row.front();
        set.stiffness.row(i) = Eigen::Map<const Eigen::RowVectorXd>(row.data() + 1, P);
    }
    if (n > 0 && !(set.weights.sum() > 0)) {
        throw InvalidInput(file.string() + ": all weights are 0; run identify again");
    }
    if (n > 0) set.weights /= set.weights.sum();
    return set;
}

}  // namespace palpate::pipeline
