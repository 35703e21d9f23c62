#include "pipeline/output/html/run_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "mesh/errors.h"
#include "mesh/formats/vtk/poly_data.h"
#include "mesh/formats/yaml/yaml_fields.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/case/json_file.h"
#include "pipeline/output/csv/posterior.h"
#include "pipeline/output/text/words.h"
#include "skeleton/model/io/model_io.h"

namespace palpate::pipeline {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

json read_if_there(const fs::path& file) { return fs::exists(file) ? json_of_file(file) : json(); }

/// As `skeleton --quality` leaves it beside a model, else the run's own short one.
json read_quality(const fs::path& folder) {
    for (const auto& entry : fs::directory_iterator(folder)) {
        if (entry.path().filename().string().ends_with("_quality.json")) return json_of_file(entry.path());
    }
    return read_if_there(folder / "sphere_curve.json");
}

/// What the settings of a run (case.yaml) say of it.
PriorKind prior_in(const fs::path& settings) {
    const mesh::YamlFields yaml = mesh::YamlFields::from_file(settings);
    const bool is_even = yaml.has("identify") && yaml.mapping("identify").text("method") == "burion2008";
    return is_even ? PriorKind::even : PriorKind::log_normal;
}

std::vector<Dot> errors_before(const json& compare) {
    std::vector<Dot> dots;
    for (const json& m : compare["markers"]) {
        dots.push_back({{m["at"][0].get<double>(), m["at"][1].get<double>(), m["at"][2].get<double>()},
                        m["rms_mm"].get<double>(),
                        m.value("strange", false)});
    }
    return dots;
}

/// Rms over measured coordinates and all states of each marker of a ladder's step.
std::vector<Dot> errors_after(const fs::path& step) {
    const mesh::PolyData markers = mesh::read_poly_data(step);
    const auto array = [&](const char* name) -> const Eigen::MatrixXd& {
        const auto found = std::ranges::find(markers.data.points, name, &mesh::DataArray::name);
        if (found == markers.data.points.end()) {
            throw InvalidInput(fmt::format("{}: has no array '{}'; run it again", step.string(), name));
        }
        return found->values;
    };
    const Eigen::MatrixXd &ids = array("marker"), &read = array("coordinates"), &errors = array("error [mm]"),
                          &measured = array("measured [mm]");
    struct Sum {
        Vec3 rest = Vec3::Zero();
        double squares = 0;
        int count = 0;
    };
    std::map<int, Sum> sums;
    for (Eigen::Index i = 0; i < ids.rows(); ++i) {
        Sum& sum = sums[static_cast<int>(ids(i, 0))];
        sum.rest = markers.points.row(i).transpose() - measured.row(i).transpose();
        sum.squares += errors.row(i).squaredNorm();
        sum.count += static_cast<int>(read(i, 0));
    }
    std::vector<Dot> dots;
    for (const auto& [id, sum] : sums) {
        if (sum.count > 0) dots.push_back({sum.rest, std::sqrt(sum.squares / sum.count)});
    }
    return dots;
}

}  // namespace

std::vector<std::string> added_effects(const RunFiles& files) {
    if (files.ladder.is_null()) return {};
    return files.ladder["steps"].back()["effects"].get<std::vector<std::string>>();
}

std::string with_what(const RunFiles& files) {
    const std::vector<std::string> added = added_effects(files);
    return added.empty() ? "nothing added" : "with " + listed(added);
}

RunFiles read_run(const fs::path& run) {
    if (!fs::exists(run / "run.json")) {
        throw InvalidInput(
            fmt::format("{}: holds no run.json, so it is no run folder; palpate run makes one", run.string()));
    }
    RunFiles files;
    files.record = json_of_file(run / "run.json");
    files.compare = json_of_file(run / "compare/compare.json");
    files.diagnosis = read_if_there(run / "diagnose/diagnosis.json");
    files.ladder = read_if_there(run / "improve/ladder.json");
    files.quality = read_quality(run / "skeleton");
    files.settings = mesh::read_text(run / "case.yaml");
    files.best = files.ladder.is_null() ? "identify" : "improve";
    files.posterior = read_posterior(run / files.best / "posterior.csv");
    if (const fs::path particles = run / files.best / "particles.csv"; fs::exists(particles))
        files.particles = read_particles(particles);
    files.prior = prior_in(run / "case.yaml");
    files.model = skeleton::read_model(run / files.best / "model.json");
    files.errors_before = errors_before(files.compare);
    if (const json identified = read_if_there(run / files.best / "identify.json"); identified.is_object())
        files.notes = identified["notes"].get<std::vector<std::string>>();
    if (!added_effects(files).empty()) {
        files.improved = read_if_there(run / "improve/compare.json");
        files.errors_after =
            errors_after(run / fmt::format("improve/ladder_{:03}.vtp", files.ladder["steps"].size() - 1));
    }
    return files;
}

}  // namespace palpate::pipeline
