#include "pipeline/live/cloud_file.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

constexpr const char* cloud_format = "palpate-cloud/1";

json numbers(const Eigen::MatrixXd& values) {
    return std::vector<double>(values.data(), values.data() + values.size());
}

Eigen::VectorXd vector(const json& values) {
    const auto found = values.get<std::vector<double>>();
    return Eigen::Map<const Eigen::VectorXd>(found.data(), std::ssize(found));
}

json name_json(const identify::StateName& name) { return {name.probe, name.time}; }

identify::StateName name_of(const json& value) { return {value.at(0).get<int>(), value.at(1).get<double>()}; }

}  // namespace

void write_cloud(const std::filesystem::path& file, const Cloud& cloud) {
    const identify::FilterState& state = cloud.state;
    json seen = json::array();
    for (const identify::StateName& name : state.seen) seen.push_back(name_json(name));
    const json object = {{"format", cloud_format},
                         {"begun_with", cloud.begun_with},
                         {"readings", state.readings},
                         {"mean", numbers(state.v)},
                         {"information", numbers(state.spectrum.values)},
                         {"directions", numbers(state.spectrum.vectors)},
                         {"seen", seen},
                         {"surprise", state.change.sum},
                         {"since", state.change.since ? name_json(*state.change.since) : json()},
                         {"off", numbers(state.change.off)},
                         {"off_count", state.change.count}};
    mesh::write_text(file, object.dump() + "\n");
}

Cloud read_cloud(const std::filesystem::path& file) {
    try {
        const json object = json::parse(mesh::read_text(file));
        if (object.at("format") != cloud_format) throw InvalidInput("");
        Cloud cloud;
        cloud.begun_with = object.at("begun_with").get<int>();
        identify::FilterState& state = cloud.state;
        state.readings = object.at("readings").get<int>();
        state.v = vector(object.at("mean"));
        state.spectrum.values = vector(object.at("information"));
        const Eigen::VectorXd directions = vector(object.at("directions"));
        if (directions.size() != state.v.size() * state.spectrum.values.size()) throw InvalidInput("");
        state.spectrum.vectors = directions.reshaped(state.v.size(), state.spectrum.values.size());
        for (const json& name : object.at("seen")) state.seen.insert(name_of(name));
        state.change.sum = object.at("surprise").get<double>();
        if (!object.at("since").is_null()) state.change.since = name_of(object.at("since"));
        state.change.off = vector(object.at("off"));
        state.change.count = object.at("off_count").get<int>();
        return cloud;
    } catch (const IoError&) {
        throw;
    } catch (const std::exception&) {
        throw InvalidInput(
            fmt::format("{}: is no cloud of particles ({}); remove it to begin anew", file.string(), cloud_format));
    }
}

}  // namespace palpate::pipeline
