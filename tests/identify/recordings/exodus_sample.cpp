#include "tests/identify/recordings/exodus_sample.h"

#include <netcdf.h>

#include <array>
#include <stdexcept>
#include <utility>

namespace palpate::identify {
namespace {

void require(int status) {
    if (status != NC_NOERR) throw std::runtime_error(nc_strerror(status));
}

}  // namespace

std::filesystem::path write_exodus(const std::filesystem::path& file, const ExodusSample& sample) {
    int out = 0;
    require(nc_create(file.c_str(), NC_CLOBBER | NC_64BIT_OFFSET, &out));
    const auto dimension = [&](const char* name, std::size_t size) {
        int id = 0;
        require(nc_def_dim(out, name, size, &id));
        return id;
    };
    const auto variable = [&](const std::string& name, nc_type type, std::vector<int> dimensions) {
        int id = 0;
        require(nc_def_var(out, name.c_str(), type, static_cast<int>(dimensions.size()), dimensions.data(), &id));
        return id;
    };
    constexpr std::size_t width = 33, nodes = 2;
    const auto along = static_cast<std::size_t>(sample.dimensions);
    // (instant, node), the second running fastest
    std::vector<std::pair<std::string, std::array<double, 4>>> fields{{sample.displacement + "X", {0.5, 0.5, 1, 1}},
                                                                      {sample.displacement + "Y", {0, 0, 0, 0}}};
    if (sample.dimensions == 3) fields.push_back({sample.displacement + "Z", {0, 0, 0.25, 0.25}});
    if (sample.has_sigma) {
        fields.push_back({"SIGMA", {0.01, 0.01, 0.01, -1}});
        fields.push_back({"GAMMA", {0, 0, 0, 0}});
    }
    const int instant = dimension("time_step", NC_UNLIMITED), node = dimension("num_nodes", nodes),
              axis = dimension("num_dim", along), text = dimension("len_name", width),
              field = dimension("num_nod_var", fields.size());
    const int clock = variable("time_whole", NC_DOUBLE, {instant});
    const int names = variable("name_nod_var", NC_CHAR, {field, text});
    std::vector<int> places, values;
    if (sample.is_one_variable) places.push_back(variable("coord", NC_DOUBLE, {axis, node}));
    for (std::size_t k = 0; k < along && !sample.is_one_variable; ++k)
        places.push_back(variable(std::string("coord") + "xyz" [k], NC_DOUBLE, { node }));
    for (std::size_t v = 0; v < fields.size(); ++v)
        values.push_back(variable("vals_nod_var" + std::to_string(v + 1), NC_FLOAT, {instant, node}));
    const int ids = sample.has_ids ? variable("node_num_map", NC_INT, {node}) : 0;
    require(nc_enddef(out));

    constexpr std::array<double, 6> coordinates{1, 4, 2, 5, 3, 6};
    for (std::size_t k = 0; k < places.size(); ++k) require(nc_put_var_double(out, places[k], &coordinates[2 * k]));
    for (std::size_t v = 0; v < fields.size(); ++v) {
        const std::array<std::size_t, 2> start{v, 0}, all{1, fields[v].first.size()};
        require(nc_put_vara_text(out, names, start.data(), all.data(), fields[v].first.c_str()));
        const std::array<std::size_t, 2> first{0, 0}, given{sample.times.size(), nodes};
        require(nc_put_vara_double(out, values[v], first.data(), given.data(), fields[v].second.data()));
    }
    const std::size_t first = 0, instants = sample.times.size();
    require(nc_put_vara_double(out, clock, &first, &instants, sample.times.data()));
    constexpr std::array<int, 2> own_ids{17, 18};
    if (sample.has_ids) require(nc_put_var_int(out, ids, own_ids.data()));
    require(nc_close(out));
    return file;
}

}  // namespace palpate::identify
