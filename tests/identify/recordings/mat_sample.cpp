#include "tests/identify/recordings/mat_sample.h"

#include <matio.h>

#include <array>
#include <limits>
#include <string>
#include <vector>

namespace palpate::identify {
namespace {

matvar_t* matrix(std::vector<double> values, std::size_t rows) {
    std::array<std::size_t, 2> size{rows, values.size() / rows};
    return Mat_VarCreate(nullptr, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size.data(), values.data(), 0);
}

matvar_t* characters(std::string value) {
    std::array<std::size_t, 2> size{1, value.size()};
    return Mat_VarCreate(nullptr, MAT_C_CHAR, MAT_T_UTF8, 2, size.data(), value.data(), 0);
}

matvar_t* structure(const char* name, const std::vector<const char*>& fields, std::size_t count = 1) {
    std::array<std::size_t, 2> size{1, count};
    auto names = fields;
    return Mat_VarCreateStruct(name, 2, size.data(), names.data(), static_cast<unsigned>(names.size()));
}

matvar_t* cells(std::vector<matvar_t*> contents) {
    std::array<std::size_t, 2> size{contents.size(), 1};
    return Mat_VarCreate(nullptr, MAT_C_CELL, MAT_T_CELL, 2, size.data(), contents.data(), 0);
}

std::filesystem::path write(const std::filesystem::path& file, matvar_t* variable) {
    mat_t* out = Mat_CreateVer(file.c_str(), nullptr, MAT_FT_MAT5);
    Mat_VarWrite(out, variable, MAT_COMPRESSION_ZLIB);
    Mat_VarFree(variable);
    Mat_Close(out);
    return file;
}

}  // namespace

std::filesystem::path write_ncorr(const std::filesystem::path& file, double spacing, bool is_even) {
    matvar_t* displacements = structure(nullptr, {"plot_u_ref_formatted", "plot_v_ref_formatted"}, 2);
    for (std::size_t f = 0; f < 2; ++f) {
        const double u = 0.5 * static_cast<double>(f + 1), v = 0.25;
        Mat_VarSetStructFieldByName(displacements, "plot_u_ref_formatted", f,
                                    matrix({0, u, u, u, u, u}, f == 0 || is_even ? 2 : 3));
        Mat_VarSetStructFieldByName(displacements, "plot_v_ref_formatted", f, matrix({0, v, v, v, v, v}, 2));
    }
    matvar_t* info = structure(nullptr, {"spacing", "pixtounits", "units"});
    Mat_VarSetStructFieldByName(info, "spacing", 0, matrix({spacing}, 1));
    Mat_VarSetStructFieldByName(info, "pixtounits", 0, matrix({0.1}, 1));
    Mat_VarSetStructFieldByName(info, "units", 0, characters("mm"));
    matvar_t* saved = structure("data_dic_save", {"displacements", "dispinfo"});
    Mat_VarSetStructFieldByName(saved, "displacements", 0, displacements);
    Mat_VarSetStructFieldByName(saved, "dispinfo", 0, info);
    return write(file, saved);
}

std::filesystem::path write_multidic(const std::filesystem::path& file, bool is_even) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    matvar_t* moved = structure(nullptr, {"DispVec"});
    Mat_VarSetStructFieldByName(moved, "DispVec", 0,
                                cells({matrix({0, 0, 0, 0, 0, 0}, 2), matrix({0.5, nan, 0, nan, 0, nan}, 2)}));
    matvar_t* results = structure("DIC3DPPresults", {"Points3D", "Disp"});
    Mat_VarSetStructFieldByName(
        results, "Points3D", 0,
        cells({matrix({1, 4, 2, 5, 3, 6}, 2), matrix({1.5, nan, 2, nan, 3, nan}, is_even ? 2 : 3)}));
    Mat_VarSetStructFieldByName(results, "Disp", 0, moved);
    return write(file, results);
}

std::filesystem::path write_other_mat(const std::filesystem::path& file) {
    double answer = 42;
    std::array<std::size_t, 2> size{1, 1};
    return write(file, Mat_VarCreate("answer", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size.data(), &answer, 0));
}

}  // namespace palpate::identify
