#pragma once

#include <Eigen/Core>
#include <cereal/archives/binary.hpp>
#include <cereal/types/string.hpp>
#include <cereal/types/vector.hpp>
#include <sstream>
#include <string>

#include "mesh/core/surface.h"

// Data as bytes, to come back from a child process: of this program on this machine, never of a file.

namespace cereal {

template <class Archive, class T, int rows, int columns, int options, int most_rows, int most_columns>
void save(Archive& archive, const Eigen::Matrix<T, rows, columns, options, most_rows, most_columns>& m) {
    archive(m.rows(), m.cols());
    if (m.size() > 0) archive(binary_data(m.data(), static_cast<std::size_t>(m.size()) * sizeof(T)));
}

template <class Archive, class T, int rows, int columns, int options, int most_rows, int most_columns>
void load(Archive& archive, Eigen::Matrix<T, rows, columns, options, most_rows, most_columns>& m) {
    Eigen::Index height = 0, width = 0;
    archive(height, width);
    m.resize(height, width);
    if (m.size() > 0) archive(binary_data(m.data(), static_cast<std::size_t>(m.size()) * sizeof(T)));
}

}  // namespace cereal

namespace palpate::mesh {

template <class Archive>
void serialize(Archive& archive, Surface& surface) {
    archive(surface.vertices, surface.triangles);
}

template <class... Parts>
std::string to_bytes(const Parts&... parts) {
    std::ostringstream bytes;
    cereal::BinaryOutputArchive{bytes}(parts...);
    return std::move(bytes).str();
}

/// @throws cereal::Exception when they end too soon.
template <class... Parts>
void from_bytes(std::string bytes, Parts&... parts) {
    std::istringstream stream(std::move(bytes));
    cereal::BinaryInputArchive{stream}(parts...);
}

}  // namespace palpate::mesh
