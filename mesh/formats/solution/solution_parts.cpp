#include "mesh/formats/solution/solution_parts.h"

#include <fmt/format.h>

#include "mesh/errors.h"

namespace palpate::mesh {

NodeRows::NodeRows(const std::vector<std::int64_t>& numbers, const std::filesystem::path& file) {
    for (std::size_t i = 0; i < numbers.size(); ++i)
        if (!rows_.try_emplace(numbers[i], static_cast<Eigen::Index>(i)).second)
            throw InvalidInput(
                fmt::format("{}: node {} stands there twice. Export the mesh again.", file.string(), numbers[i]));
}

Eigen::Index NodeRows::row(std::int64_t number, const std::string& where) const {
    const auto found = rows_.find(number);
    if (found == rows_.end())
        throw InvalidInput(fmt::format("{}: a displacement of node {}, which the mesh does not hold.", where, number));
    return found->second;
}

}  // namespace palpate::mesh
