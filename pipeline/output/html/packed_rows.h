#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <vector>

#include "pipeline/output/base64.h"

namespace palpate::pipeline {

/// Numbers as data.js reads them: {type, data}. `type`: "f32", "i32" or "i16", what `Number` is.
template <class Number>
nlohmann::json packed(const char* type, const std::vector<Number>& numbers) {
    return {{"type", type},
            {"data", base64({reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)})}};
}

/// The entries of a matrix, row by row.
template <class Number, class Matrix>
std::vector<Number> flat(const Matrix& matrix) {
    std::vector<Number> numbers;
    numbers.reserve(static_cast<std::size_t>(matrix.size()));
    for (Eigen::Index i = 0; i < matrix.rows(); ++i)
        for (Eigen::Index c = 0; c < matrix.cols(); ++c) numbers.push_back(static_cast<Number>(matrix(i, c)));
    return numbers;
}

}  // namespace palpate::pipeline
