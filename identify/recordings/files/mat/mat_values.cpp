#include "identify/recordings/files/mat/mat_values.h"

#include <fmt/format.h>
#include <matio.h>

#include <limits>
#include <memory>
#include <utility>

#include "identify/recordings/files/read_in_child.h"
#include "mesh/errors.h"

namespace palpate::identify {

template <class Archive>
void serialize(Archive& archive, MatCorrelation& data) {
    archive(data.u, data.v, data.spacing, data.unit_per_pixel, data.unit, data.points, data.displacements,
            data.variables);
}

namespace {

struct Closer {
    void operator()(mat_t* file) const { Mat_Close(file); }
    void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using MatFile = std::unique_ptr<mat_t, Closer>;
using MatVariable = std::unique_ptr<matvar_t, Closer>;

template <class T>
Eigen::MatrixXd cast(const matvar_t& variable, Eigen::Index rows, Eigen::Index columns) {
    using Matrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;
    return Eigen::Map<const Matrix>(static_cast<const T*>(variable.data), rows, columns).template cast<double>();
}

/// A real matrix; empty where the variable is none.
Eigen::MatrixXd matrix_of(mat_t* file, matvar_t* variable) {
    if (!variable || variable->rank != 2 || variable->isComplex) return {};
    if (!variable->data && Mat_VarReadDataAll(file, variable) != 0) return {};
    if (!variable->data) return {};
    const auto rows = static_cast<Eigen::Index>(variable->dims[0]),
               columns = static_cast<Eigen::Index>(variable->dims[1]);
    if (variable->nbytes < variable->dims[0] * variable->dims[1] * static_cast<std::size_t>(variable->data_size))
        return {};
    switch (variable->data_type) {
        case MAT_T_DOUBLE:
            return cast<double>(*variable, rows, columns);
        case MAT_T_SINGLE:
            return cast<float>(*variable, rows, columns);
        case MAT_T_INT32:
            return cast<std::int32_t>(*variable, rows, columns);
        case MAT_T_UINT32:
            return cast<std::uint32_t>(*variable, rows, columns);
        case MAT_T_INT16:
            return cast<std::int16_t>(*variable, rows, columns);
        case MAT_T_UINT16:
            return cast<std::uint16_t>(*variable, rows, columns);
        case MAT_T_INT8:
            return cast<std::int8_t>(*variable, rows, columns);
        case MAT_T_UINT8:
            return cast<std::uint8_t>(*variable, rows, columns);
        default:
            return {};
    }
}

double scalar_of(mat_t* file, matvar_t* variable, double otherwise) {
    const Eigen::MatrixXd matrix = matrix_of(file, variable);
    return matrix.size() > 0 ? matrix(0, 0) : otherwise;
}

std::string text_of(mat_t* file, matvar_t* variable) {
    if (!variable || variable->class_type != MAT_C_CHAR) return {};
    if (!variable->data && Mat_VarReadDataAll(file, variable) != 0) return {};
    std::string text;
    const std::size_t size = variable->data ? variable->nbytes : 0;
    const std::size_t width = variable->data_size > 0 ? static_cast<std::size_t>(variable->data_size) : 1;
    for (std::size_t i = 0; i < size; i += width)
        if (const char c = static_cast<const char*>(variable->data)[i]; c != '\0') text += c;
    return text;
}

matvar_t* field(matvar_t* variable, const char* name, std::size_t index = 0) {
    if (!variable || variable->class_type != MAT_C_STRUCT) return nullptr;
    return Mat_VarGetStructFieldByName(variable, name, index);
}

std::size_t size_of(const matvar_t& variable) {
    std::size_t size = variable.rank > 0 ? 1 : 0;
    for (int d = 0; d < variable.rank; ++d) size *= variable.dims[d];
    return size;
}

void take_ncorr(mat_t* file, matvar_t* data, MatCorrelation& result) {
    matvar_t* displacements = field(data, "displacements");
    if (!displacements) return;
    for (std::size_t f = 0; f < size_of(*displacements); ++f) {
        result.u.push_back(matrix_of(file, field(displacements, "plot_u_ref_formatted", f)));
        result.v.push_back(matrix_of(file, field(displacements, "plot_v_ref_formatted", f)));
    }
    matvar_t* info = field(data, "dispinfo");
    result.spacing = scalar_of(file, field(info, "spacing"), 0);
    result.unit_per_pixel = scalar_of(file, field(info, "pixtounits"), 1);
    result.unit = text_of(file, field(info, "units"));
}

std::vector<Eigen::MatrixXd> cells_in(mat_t* file, matvar_t* cells) {
    std::vector<Eigen::MatrixXd> matrices;
    if (!cells || cells->class_type != MAT_C_CELL) return matrices;
    for (std::size_t c = 0; c < size_of(*cells); ++c)
        matrices.push_back(matrix_of(file, Mat_VarGetCell(cells, static_cast<int>(c))));
    return matrices;
}

MatCorrelation read_mat_here(const std::filesystem::path& file) {
    MatCorrelation result;
    const MatFile in(Mat_Open(file.c_str(), MAT_ACC_RDONLY));
    if (!in)
        throw InvalidInput(fmt::format("{}: this is no whole MATLAB file. Save it again.", file.filename().string()));
    for (MatVariable variable(Mat_VarReadNextInfo(in.get())); variable; variable.reset(Mat_VarReadNextInfo(in.get()))) {
        if (!variable->name) continue;
        result.variables.emplace_back(variable->name);
        if (result.variables.back() == "data_dic_save") {
            take_ncorr(in.get(), variable.get(), result);
        } else if (matvar_t* points = field(variable.get(), "Points3D"); points && result.points.empty()) {
            result.points = cells_in(in.get(), points);
            result.displacements = cells_in(in.get(), field(field(variable.get(), "Disp"), "DispVec"));
        }
    }
    return result;
}

}  // namespace

MatCorrelation read_mat_correlation(const std::filesystem::path& file) {
    constexpr double most_packed = 20;  // zlib packs matrices of numbers no denser
    return read_in_child<MatCorrelation>(file, "MATLAB", most_packed, read_mat_here);
}

}  // namespace palpate::identify
