#include "pipeline/synthesis/external_solver/results_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "mesh/errors.h"
#include "mesh/formats/solution/read_solution.h"
#include "mesh/formats/vtk/poly_data.h"
#include "mesh/text/words.h"
#include "pipeline/synthesis/external_solver/nodal_loads.h"

namespace palpate::pipeline {
namespace {

namespace fs = std::filesystem;
using identify::LoadState;

/// Files of one kind, in order; a .frd speaks for the .dat beside it, a .pvd tells the order of its files.
std::vector<fs::path> results_in(const fs::path& folder) {
    std::map<std::string, std::vector<fs::path>> of_kind;
    std::vector<fs::path> series;
    for (const auto& entry : fs::directory_iterator(folder)) {
        if (!entry.is_regular_file()) continue;
        if (mesh::is_solution_file(entry.path())) of_kind[entry.path().extension().string()].push_back(entry.path());
        if (entry.path().extension() == ".pvd") series.push_back(entry.path());
    }
    if (series.size() == 1) {
        std::vector<fs::path> files;
        for (const mesh::SeriesStep& step : mesh::read_pvd(series.front())) files.push_back(step.file);
        return files;
    }
    if (of_kind.contains(".frd")) of_kind.erase(".dat");
    if (of_kind.empty())
        throw InvalidInput(
            fmt::format("{}: holds no results; .frd, .dat (CalculiX), .vtu or .vtp (ParaView, meshio) "
                        "are read.",
                        folder.string()));
    if (of_kind.size() > 1)
        throw InvalidInput(fmt::format("{}: holds results of several kinds ({} and {}); keep one kind.",
                                       folder.string(), of_kind.begin()->first, std::next(of_kind.begin())->first));
    std::vector<fs::path> files = of_kind.begin()->second;
    std::ranges::sort(files, mesh::is_before_by_numbers, [](const fs::path& path) { return path.filename().string(); });
    return files;
}

std::optional<mesh::Deck> deck_in(const fs::path& folder, const fs::path& first_result) {
    const fs::path namesake = fs::path(first_result).replace_extension(".inp");
    if (fs::exists(namesake)) return mesh::read_deck(namesake);
    std::vector<fs::path> decks;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().extension() == ".inp") decks.push_back(entry.path());
    if (decks.size() == 1) return mesh::read_deck(decks.front());
    return std::nullopt;
}

/// Of increments of one step the last.
std::vector<std::size_t> ends_of_steps(const mesh::Solution& solution) {
    std::vector<std::size_t> ends;
    for (std::size_t s = 0; s < solution.steps.size(); ++s) {
        const int step = solution.steps[s].load_step;
        if (!ends.empty() && step > 0 && solution.steps[ends.back()].load_step == step) ends.pop_back();
        ends.push_back(s);
    }
    return ends;
}

class Pairing {
public:
    explicit Pairing(ResultsFolder& folder) : folder_(folder) {}

    /// False where the files are not called by probe and time, all of them that a state needs.
    bool by_name(const std::vector<fs::path>& files) {
        std::map<std::string, fs::path> of_name;
        for (const fs::path& file : files) of_name[file.stem().string()] = file;
        std::vector<FieldPlace> fields;
        for (const LoadState& state : folder_.states) {
            const auto found = of_name.find(identify::field_file(state).stem().string());
            if (found == of_name.end()) return false;
            fields.push_back({found->second});
        }
        folder_.fields = std::move(fields);
        return true;
    }

    void in_order(const std::vector<fs::path>& files, const std::string& array) {
        std::vector<FieldPlace> ends, all;
        for (const fs::path& file : files) {
            const std::string extension = file.extension().string();
            if (extension == ".vtu" || extension == ".vtp") {  // one step a file
                ends.push_back({file});
                all.push_back({file});
                continue;
            }
            const mesh::Solution solution = folder_.read(file, array);
            for (const std::size_t step : ends_of_steps(solution)) ends.push_back({file, step});
            for (std::size_t step = 0; step < solution.steps.size(); ++step) all.push_back({file, step});
        }
        if (ends.size() != folder_.states.size() && all.size() == folder_.states.size()) ends = all;
        if (ends.size() != folder_.states.size()) leave_out_unloaded(ends.size());
        if (ends.size() != folder_.states.size())
            throw InvalidInput(
                fmt::format("{}: {} fields for {} states ({}); there must be one each, in their order, or files called "
                            "<probe>_<time>.",
                            folder_.folder.string(), ends.size(), folder_.states.size(), source_));
        folder_.fields = std::move(ends);
    }

    void set_source(const std::string& source) { source_ = source; }

private:
    /// Nobody computes a body that nothing touches.
    void leave_out_unloaded(std::size_t fields) {
        const auto is_unloaded = [](const LoadState& state) { return state.contacts.empty(); };
        const auto loaded =
            folder_.states.size() - static_cast<std::size_t>(std::ranges::count_if(folder_.states, is_unloaded));
        if (fields != loaded) return;
        folder_.notes.push_back(
            fmt::format("{} states without load have no field: left out.", folder_.states.size() - loaded));
        std::erase_if(folder_.states, is_unloaded);
    }

    ResultsFolder& folder_;
    std::string source_;
};

}  // namespace

mesh::Solution ResultsFolder::read(const fs::path& file, const std::string& array) const {
    return mesh::read_solution(file, deck ? &*deck : nullptr, array);
}

ResultsFolder scan_results(const fs::path& folder, double unit, const std::string& array) {
    if (!fs::is_directory(folder))
        throw IoError(
            fmt::format("{}: no such folder; --from takes the folder of a solver's results.", folder.string()));
    ResultsFolder found;
    found.folder = folder;
    const std::vector<fs::path> files = results_in(folder);
    found.deck = deck_in(folder, files.front());
    if (found.deck) found.notes = found.deck->notes;

    Pairing pairing(found);
    if (const fs::path table = folder / "probes.csv"; fs::exists(table)) {
        found.states = identify::read_probes(table);
        for (LoadState& state : found.states)
            for (mesh::Contact& contact : state.contacts) {
                contact.point *= unit;
                contact.radius *= unit;
            }
        pairing.set_source("of probes.csv");
    } else if (found.deck && !found.deck->steps.empty()) {
        found.states = states_of_steps(*found.deck, unit, found.notes);
        pairing.set_source("steps of " + found.deck->file.filename().string());
    } else {
        throw InvalidInput(fmt::format(
            "{}: nothing specifies the loads; put a probes.csv (probe,time,x,y,z,fx,fy,fz,radius) beside the "
            "results, or the .inp file with a *STEP and *CLOAD for each.",
            folder.string()));
    }
    if (!pairing.by_name(files)) pairing.in_order(files, array);
    return found;
}

}  // namespace palpate::pipeline
