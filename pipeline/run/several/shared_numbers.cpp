#include "pipeline/run/several/shared_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "identify/effects/catalogue.h"
#include "mesh/errors.h"
#include "pipeline/output/html/run_files.h"
#include "pipeline/output/text/comparison/population.h"

namespace palpate::pipeline {
namespace {

namespace fs = std::filesystem;
using identify::SpecimenNumber;
using nlohmann::json;

constexpr const char* finite_elements = "finite elements";

// Half-normal scale of what logarithms may differ by among specimens, wide for what is made or grown alike. Of other
// numbers it is the largest of them.
constexpr double factor_of_e = 1;

/// Gathers numbers by name, in the order in which they are met.
class Numbers {
public:
    /// A number known to a standard deviation, in its own unit.
    struct Known {
        double value, sd;
    };
    void add(const std::string& name, const std::string& unit, const std::string& run, const Known& known) {
        if (!(known.sd > 0) || !std::isfinite(known.value)) return;
        Entry& entry = find(name, unit, finite_elements);
        entry.runs.push_back(run);
        entry.known.push_back(known);
    }
    void add(const std::string& name, const std::string& unit, SpecimenNumber drawn) {
        Entry& entry = find(name, unit, "the skeleton");
        entry.runs.push_back(drawn.specimen);
        entry.drawn.push_back(std::move(drawn));
    }

    /// Those of two runs or more.
    std::vector<SharedNumber> shared(const std::vector<std::string>& runs) const {
        std::vector<SharedNumber> result;
        for (const Entry& entry : entries_) {
            if (entry.runs.size() < 2) continue;
            result.push_back(entry.drawn.empty() ? of_known(entry) : of_drawn(entry));
            for (const std::string& run : runs)
                if (std::ranges::find(entry.runs, run) == entry.runs.end()) result.back().without.push_back(run);
        }
        return result;
    }

private:
    struct Entry {
        std::string name, unit, of;
        std::vector<std::string> runs;
        std::vector<Known> known;
        std::vector<SpecimenNumber> drawn;
    };

    Entry& find(const std::string& name, const std::string& unit, const std::string& of) {
        const auto own = std::ranges::find_if(entries_, [&](const Entry& e) { return e.name == name && e.of == of; });
        if (own != entries_.end()) return *own;
        entries_.push_back({name, unit, of, {}, {}, {}});
        return entries_.back();
    }

    static SharedNumber of_drawn(const Entry& entry) {
        return {entry.name, entry.unit, entry.of, PoolScale::logarithmic, factor_of_e, entry.drawn, {}};
    }

    /// A number and its deviation as they are pooled.
    static Known pooled(const Known& known, PoolScale scale) {
        switch (scale) {
            case PoolScale::logarithmic:
                return {std::log(known.value), known.sd / known.value};
            case PoolScale::compressibility:
                return {std::log(1 - 2 * known.value), 2 * known.sd / (1 - 2 * known.value)};
            case PoolScale::linear:
                break;
        }
        return known;
    }

    /// As logarithms where all are positive beyond doubt, as Young's modulus is, of which the logarithm was fitted.
    static SharedNumber of_known(const Entry& entry) {
        constexpr double beyond_doubt = 3;  // deviations above 0
        SharedNumber number{entry.name, entry.unit, entry.of, PoolScale::logarithmic, factor_of_e, {}, {}};
        double largest = 0;
        for (const Known& known : entry.known) {
            const bool is_positive = entry.name == "young" || known.value > beyond_doubt * known.sd;
            if (!is_positive) number.scale = PoolScale::linear;
            largest = std::max(largest, std::abs(known.value));
        }
        if (entry.name == "poisson") number.scale = PoolScale::compressibility;
        if (number.scale == PoolScale::linear) number.most_spread = largest;
        for (std::size_t i = 0; i < entry.known.size(); ++i) {
            const auto [x, sd] = pooled(entry.known[i], number.scale);
            number.specimens.push_back({.specimen = entry.runs[i],
                                        .draws = Eigen::VectorXd::Constant(1, x),
                                        .weights = Eigen::VectorXd::Ones(1),
                                        .sd = sd});
        }
        return number;
    }

    std::vector<Entry> entries_;
};

/// What the body in finite elements is made of, with what the diagnosis names in it, where that was added.
void add_material(const RunFiles& files, const std::string& run, Numbers& numbers) {
    json material = files.compare.value("baseline", json());
    if (!files.ladder.is_null()) {
        const json last = files.ladder["steps"].back().value("reference", json());
        if (last.contains("young_mpa")) material = last;
    }
    if (!material.contains("young_sd_mpa")) return;
    numbers.add("young", "MPa", run, {material["young_mpa"], material["young_sd_mpa"]});
    if (!material.value("poisson_declared", true))
        numbers.add("poisson", "1", run, {material["poisson"], material["poisson_sd"]});
}

void add_effects(const RunFiles& files, const std::string& run, Numbers& numbers) {
    if (files.diagnosis.is_null()) return;
    const auto named = files.diagnosis["explanation"].get<std::vector<std::string>>();
    for (const json& candidate : files.diagnosis["ranking"]) {
        const std::string effect = candidate["effect"];
        if (std::ranges::count(named, effect) != 1) continue;  // of several, which is which nobody says
        const auto known = identify::effect_named(effect);
        for (const auto& [parameter, told] : candidate["parameters"].items()) {
            if (!told["value"].is_number() || !told["sd"].is_number()) continue;
            if (known && !known->is_comparable(parameter)) continue;
            numbers.add(effect + ":" + parameter, told["unit"], run, {told["value"], told["sd"]});
        }
    }
}

/// Stiffness of the skeleton, where the measurements inform it, by the particles.
void add_skeleton(const RunFiles& files, const std::string& run, Numbers& numbers) {
    for (std::size_t p = 0; p < files.posterior.size(); ++p) {
        const identify::PosteriorRow& row = files.posterior[p];
        const auto column = std::ranges::find(files.particles.parameters, row.parameter);
        if (!row.informed || column == files.particles.parameters.end()) continue;
        SpecimenNumber own{
            .specimen = run,
            .draws = files.particles.stiffness.col(column - files.particles.parameters.begin()).array().log(),
            .weights = files.particles.weights};
        const double mean = own.weights.dot(own.draws);
        own.sd = std::sqrt(own.weights.dot((own.draws.array() - mean).square().matrix()));
        if (!(own.sd > 0) || !std::isfinite(own.sd)) continue;
        if (files.prior == PriorKind::log_normal) {
            // By the mean and the deviation of what is log-normal.
            const double ratio = row.prior_sd / row.prior_mean;
            own.prior_sd = std::sqrt(std::log1p(ratio * ratio));
            own.prior_mean = std::log(row.prior_mean) - own.prior_sd * own.prior_sd / 2;
        }
        numbers.add(row.parameter, row.unit, std::move(own));
    }
}

/// How runs are called: by their folders, with all of the paths where two are called alike.
std::vector<std::string> names_of(const std::vector<fs::path>& runs) {
    std::set<fs::path> known;
    std::set<std::string> different;
    std::vector<std::string> names, paths;
    for (const fs::path& run : runs) {
        fs::path whole = fs::weakly_canonical(run);
        if (!whole.has_filename()) whole = whole.parent_path();
        if (!known.insert(whole).second)
            throw InvalidInput(
                fmt::format("{}: is told twice; each run is of a specimen of its own, so leave one out", run.string()));
        names.push_back(whole.filename().string());
        paths.push_back(whole.string());
        different.insert(names.back());
    }
    return different.size() == names.size() ? names : paths;
}

}  // namespace

SharedBySpecimens shared_by_specimens(const std::vector<fs::path>& runs) {
    if (runs.size() < 2)
        throw InvalidInput(fmt::format(
            "a population has two specimens at least, and {} run is told; name more run folders", runs.size()));
    const std::vector<std::string> names = names_of(runs);
    Numbers numbers;
    std::vector<SpecimenModel> models;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        const RunFiles files = read_run(runs[r]);
        models.push_back({names[r], files.model});
        add_material(files, names[r], numbers);
        add_effects(files, names[r], numbers);
        add_skeleton(files, names[r], numbers);
    }
    SharedBySpecimens shared{numbers.shared(names), mean_specimen(models)};
    if (!shared.mean.model)
        shared.left_out = std::erase_if(shared.numbers, [](const auto& one) { return is_of_single_link(one.name); });
    if (shared.numbers.empty())
        throw InvalidInput(
            "no two of these runs tell the same number: no stiffness in finite elements, no effect with the same name, "
            "and no stiffness of the skeleton that measurements inform; identify them with --parameters uniform, which "
            "all skeletons have in common" +
            (shared.mean.model ? std::string() : "; single links do not correspond: " + shared.mean.why_none));
    return shared;
}

}  // namespace palpate::pipeline
