#include "pipeline/python/extension/conversions/arrays.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>

#include "mesh/errors.h"

namespace palpate::python {
namespace {

/// "float32 (4, 3)"
std::string words_for(const py::array& array) {
    return fmt::format("an array of {} {}", py::str(array.dtype()).cast<std::string>(),
                       py::str(array.attr("shape")).cast<std::string>());
}

/// Any array of numbers as doubles (or ints) in rows.
template <typename T>
py::array_t<T, py::array::c_style | py::array::forcecast> numbers_of(const py::handle& given, const char* name,
                                                                     const char* kinds, const char* shape) {
    const auto array = py::array::ensure(given);
    if (!array) {
        PyErr_Clear();
        throw InvalidInput(fmt::format("{}: is a {}, must be numbers of shape {}; give a numpy array or nested lists",
                                       name, Py_TYPE(given.ptr())->tp_name, shape));
    }
    const char kind = array.size() == 0 ? kinds[0] : array.dtype().kind();
    if (std::strchr(kinds, kind) == nullptr)
        throw InvalidInput(fmt::format("{}: is {}, must be {} of shape {}; convert it first", name, words_for(array),
                                       kinds[0] == 'i' ? "whole numbers" : "real numbers", shape));
    return py::array_t<T, py::array::c_style | py::array::forcecast>::ensure(array);
}

[[noreturn]] void refuse_shape(const py::array& array, const char* name, const std::string& shape) {
    throw InvalidInput(
        fmt::format("{}: is {}, must have the shape {}; reshape or transpose it", name, words_for(array), shape));
}

constexpr const char* real = "fiu";
constexpr const char* whole = "iu";

Vec3 finite(const Vec3& v, const char* name) {
    if (!v.allFinite())
        throw InvalidInput(fmt::format("{}: is ({}, {}, {}), must be three finite numbers; leave out what is missing",
                                       name, v.x(), v.y(), v.z()));
    return v;
}

}  // namespace

Vec3 vector_of(const py::handle& given, const char* name) {
    if (py::isinstance<py::array>(given)) {  // what a control loop gives, a million times: read as it lies
        const auto array = py::reinterpret_borrow<py::array>(given);
        const auto* seen = py::detail::array_proxy(array.ptr());
        if (py::detail::array_descriptor_proxy(seen->descr)->type == 'd' &&
            py::detail::array_descriptor_proxy(seen->descr)->byteorder != '>' && seen->nd == 1 &&
            seen->dimensions[0] == 3) {
            Vec3 v;
            for (int i = 0; i < 3; ++i) std::memcpy(&v[i], seen->data + i * seen->strides[0], sizeof(double));
            return finite(v, name);
        }
    }
    const auto array = numbers_of<double>(given, name, real, "(3,)");
    if (array.ndim() != 1 || array.size() != 3) refuse_shape(array, name, "(3,)");
    return finite(Eigen::Map<const Vec3>(array.data()), name);
}

Points points_of(const py::handle& given, const char* name) {
    const auto array = numbers_of<double>(given, name, real, "(n, 3)");
    if (array.ndim() != 2 || array.shape(1) != 3) refuse_shape(array, name, "(n, 3)");
    Points points = Eigen::Map<const Points>(array.data(), array.shape(0), 3);
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        if (points.row(i).allFinite()) continue;
        throw InvalidInput(fmt::format("{}: row {} is ({}, {}, {}), must be three finite numbers; leave that row out",
                                       name, i, points(i, 0), points(i, 1), points(i, 2)));
    }
    return points;
}

Triangles triangles_of(const py::handle& given, const char* name, Eigen::Index vertices) {
    const auto array = numbers_of<long long>(given, name, whole, "(m, 3)");
    if (array.ndim() != 2 || array.shape(1) != 3) refuse_shape(array, name, "(m, 3)");
    Triangles triangles(array.shape(0), 3);
    for (Eigen::Index i = 0; i < triangles.size(); ++i) {
        const long long corner = array.data()[i];
        if (corner < 0 || corner >= vertices)
            throw InvalidInput(fmt::format("{}: row {} names vertex {}, there are {}, numbered from 0", name, i / 3,
                                           corner, vertices));
        triangles.data()[i] = static_cast<int>(corner);
    }
    return triangles;
}

Eigen::MatrixXd matrix_of(const py::handle& given, const char* name, Eigen::Index rows, Eigen::Index columns) {
    const std::string shape = fmt::format("({}, {})", rows, columns);
    const auto array = numbers_of<double>(given, name, real, shape.c_str());
    if (array.ndim() != 2 || array.shape(0) != rows || array.shape(1) != columns) refuse_shape(array, name, shape);
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    return Eigen::Map<const Rows>(array.data(), rows, columns);
}

}  // namespace palpate::python
