#include "identify/recordings/files/exodus/exodus_values.h"

#include <fmt/format.h>
#include <netcdf.h>

#include <algorithm>
#include <optional>

#include "identify/recordings/files/read_in_child.h"
#include "identify/recordings/files/text/cell.h"
#include "mesh/errors.h"

namespace palpate::identify {

template <class Archive>
void serialize(Archive& archive, NodalField& field) {
    archive(field.name, field.values);
}

template <class Archive>
void serialize(Archive& archive, ExodusNodes& nodes) {
    archive(nodes.coordinates, nodes.times, nodes.fields, nodes.ids);
}

namespace {

/// A netCDF file by the names in it.
class NetcdfFile {
public:
    explicit NetcdfFile(const std::filesystem::path& file) : name_(file.filename().string()) {
        if (nc_open(file.c_str(), NC_NOWRITE, &id_) != NC_NOERR)
            throw InvalidInput(
                fmt::format("{}: this is no whole Exodus file, of netCDF and HDF5 files the only kind that is read "
                            "besides MATLAB's. "
                            "Write it again, or export the data as CSV.",
                            name_));
    }
    NetcdfFile(const NetcdfFile&) = delete;
    NetcdfFile& operator=(const NetcdfFile&) = delete;
    ~NetcdfFile() { nc_close(id_); }

    /// 0: there is no such dimension.
    std::size_t size(const char* dimension) const {
        int found = 0;
        std::size_t size = 0;
        if (nc_inq_dimid(id_, dimension, &found) != NC_NOERR || nc_inq_dimlen(id_, found, &size) != NC_NOERR) return 0;
        return size;
    }

    /// (first size x second size), the second running fastest in the file; absent: there is no such variable.
    /// @throws InvalidInput where it is of another size, or its end is missing
    std::optional<Eigen::MatrixXd> matrix(const std::string& variable, std::size_t rows,
                                          std::size_t columns = 1) const {
        const std::optional<int> found = place_of(variable, rows, columns);
        if (!found) return std::nullopt;
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> values(
            static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
        if (values.size() > 0 && nc_get_var_double(id_, *found, values.data()) != NC_NOERR) refuse(variable);
        return values;
    }

    /// Texts of a width each; empty: there is no such variable.
    std::vector<std::string> texts(const std::string& variable, std::size_t count, std::size_t width) const {
        const std::optional<int> found = place_of(variable, count, width);
        std::vector<std::string> texts;
        if (!found || count * width == 0) return texts;
        std::string all(count * width, '\0');
        if (nc_get_var_text(id_, *found, all.data()) != NC_NOERR) refuse(variable);
        for (std::size_t t = 0; t < count; ++t) {
            std::string text = all.substr(t * width, width);
            text.resize(std::min(text.find('\0'), text.size()));
            text.erase(text.find_last_not_of(' ') + 1);
            texts.push_back(std::move(text));
        }
        return texts;
    }

    const std::string& name() const { return name_; }

private:
    /// Sizes are checked before anything is read: the library writes as much as the file says.
    std::optional<int> place_of(const std::string& variable, std::size_t rows, std::size_t columns) const {
        int found = 0, dimensions = 0;
        if (nc_inq_varid(id_, variable.c_str(), &found) != NC_NOERR) return std::nullopt;
        int ids[NC_MAX_VAR_DIMS];
        if (nc_inq_varndims(id_, found, &dimensions) != NC_NOERR || dimensions > 2 ||
            nc_inq_vardimid(id_, found, ids) != NC_NOERR)
            refuse(variable);
        std::size_t size = 1;
        for (int d = 0; d < dimensions; ++d) {
            std::size_t length = 0;
            if (nc_inq_dimlen(id_, ids[d], &length) != NC_NOERR) refuse(variable);
            size *= length;
        }
        if (size != rows * columns) refuse(variable);
        return found;
    }

    [[noreturn]] void refuse(const std::string& variable) const {
        throw InvalidInput(
            fmt::format("{}: its variable '{}' is of another size than its nodes and times, or its end "
                        "is missing. Write it again.",
                        name_, variable));
    }

    std::string name_;
    int id_ = 0;
};

Eigen::MatrixXd coordinates_in(const NetcdfFile& in, std::size_t nodes, std::size_t dimensions) {
    // Written as one variable by some, as one a direction by others.
    if (const auto all = in.matrix("coord", dimensions, nodes)) return all->transpose();
    Eigen::MatrixXd coordinates(nodes, dimensions);
    for (std::size_t k = 0; k < dimensions; ++k) {
        const std::string variable = std::string("coord") + "xyz"[k];
        const auto one = in.matrix(variable, nodes);
        if (!one)
            throw InvalidInput(
                fmt::format("{}: it has no variable '{}', where an Exodus file keeps its nodes. Write it "
                            "again.",
                            in.name(), variable));
        coordinates.col(static_cast<Eigen::Index>(k)) = *one;
    }
    return coordinates;
}

/// DICe writes some sixty quantities: of most the name is enough.
bool is_wanted(const std::string& name) {
    const std::string lower = lower_case(name);
    return lower == "sigma" || lower.starts_with("u_") || lower.find("disp") != lower.npos;
}

ExodusNodes read_exodus_here(const std::filesystem::path& file) {
    const NetcdfFile in(file);
    const std::size_t nodes = in.size("num_nodes"), dimensions = in.size("num_dim"), frames = in.size("time_step");
    if (nodes == 0 || dimensions < 2 || dimensions > 3)
        throw InvalidInput(fmt::format(
            "{}: a netCDF or HDF5 file with {} nodes in {} dimensions; an Exodus file has 1 or more in 2 or 3. "
            "Write the points as VTU, PLY or CSV.",
            in.name(), nodes, dimensions));
    ExodusNodes result{.coordinates = coordinates_in(in, nodes, dimensions)};
    if (const auto times = in.matrix("time_whole", frames)) result.times = *times;
    constexpr double most = 2e9;  // an int holds it
    if (const auto ids = in.matrix("node_num_map", nodes); ids && (ids->array().abs() < most).all())
        for (const double id : ids->reshaped()) result.ids.push_back(static_cast<int>(id));
    const std::size_t count = in.size("num_nod_var");
    std::size_t width = in.size("len_name");
    if (width == 0) width = in.size("len_string");
    const std::vector<std::string> names = in.texts("name_nod_var", count, width);
    for (std::size_t v = 0; v < names.size(); ++v) {
        result.fields.push_back({names[v], {}});
        if (!is_wanted(names[v])) continue;
        if (const auto values = in.matrix(fmt::format("vals_nod_var{}", v + 1), frames, nodes))
            result.fields.back().values = values->transpose();
        else
            result.fields.pop_back();
    }
    return result;
}

}  // namespace

ExodusNodes read_exodus_nodes(const std::filesystem::path& file) {
    constexpr double most_packed = 20;  // HDF5 packs numbers by zlib
    return read_in_child<ExodusNodes>(file, "Exodus", most_packed, read_exodus_here);
}

}  // namespace palpate::identify
