#pragma once

#include <pybind11/numpy.h>

#include "mesh/types.h"

// Matrices of ours as arrays of numpy, and arrays as matrices.

namespace palpate::python {

namespace py = pybind11;

/// Numbers that `owner` holds, seen as an array that cannot be written to: no copy. Strides in bytes.
template <typename T>
py::array view(const T* data, const std::vector<py::ssize_t>& shape, const std::vector<py::ssize_t>& strides,
               py::handle owner) {
    py::array seen(py::dtype::of<T>(), shape, strides, data, owner);
    py::detail::array_proxy(seen.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
    return seen;
}

/// A matrix, or a vector as one row of numbers.
template <typename Matrix>
py::array view(const Matrix& m, py::handle owner) {
    constexpr auto size = static_cast<py::ssize_t>(sizeof(typename Matrix::Scalar));
    if constexpr (Matrix::IsVectorAtCompileTime) return view(m.data(), {m.size()}, {size}, owner);
    const auto along = static_cast<py::ssize_t>(m.innerStride()) * size;
    const auto across = static_cast<py::ssize_t>(m.outerStride()) * size;
    return view(m.data(), {m.rows(), m.cols()},
                Matrix::IsRowMajor ? std::vector{across, along} : std::vector{along, across}, owner);
}

/// A member of each element of a list, beside one another in the list's own memory (n, or n x columns).
template <typename T, typename Element>
py::array view_of_members(const std::vector<Element>& list, const T* first, py::ssize_t columns, py::handle owner) {
    constexpr auto each = static_cast<py::ssize_t>(sizeof(Element)), size = static_cast<py::ssize_t>(sizeof(T));
    const auto n = static_cast<py::ssize_t>(list.size());
    if (columns == 0) return view(first, {n}, {each}, owner);
    return view(first, {n, columns}, {each, size}, owner);
}

/// Three numbers out of an array, a list or a tuple. @throws InvalidInput naming what they are.
Vec3 vector_of(const py::handle& given, const char* name);
/// (n x 3) of any numbers, in any order. @throws InvalidInput naming what they are, and the row that is not finite.
Points points_of(const py::handle& given, const char* name);
/// (m x 3), each in [0, vertices). @throws InvalidInput
Triangles triangles_of(const py::handle& given, const char* name, Eigen::Index vertices);
/// (rows x columns) @throws InvalidInput
Eigen::MatrixXd matrix_of(const py::handle& given, const char* name, Eigen::Index rows, Eigen::Index columns);

}  // namespace palpate::python
