#include <fmt/format.h>

#include <limits>

#include "mesh/errors.h"
#include "mesh/formats/solution/solution_parts.h"
#include "mesh/text/atomic_file.h"
#include "mesh/text/text_lines.h"

namespace palpate::mesh {

/// Tables of *NODE PRINT: a line that begins with "displacements" and ends with the time, then a node a line.
Solution read_dat(const std::filesystem::path& file, const Deck* deck) {
    if (!deck)
        throw InvalidInput(
            fmt::format("{}: holds no mesh; put the .inp file that it came from beside it.", file.string()));
    Solution solution = mesh_of(*deck);
    solution.file = file;
    const NodeRows rows(deck->cells.node_numbers, deck->file);

    const std::string content = read_text(file);
    TextLines lines(content, file);
    bool is_displacement = false;
    while (lines.next()) {
        const auto& words = lines.words();
        const char first = words.front().front();
        if ((first >= 'a' && first <= 'z') || (first >= 'A' && first <= 'Z')) {
            is_displacement = words.front() == "displacements";
            if (!is_displacement) continue;
            // Several sets of nodes may be printed at one time.
            const double time = lines.number(words.size() - 1, "the time");
            if (solution.steps.empty() || solution.steps.back().time != time)
                solution.steps.push_back(
                    {time, Points::Constant(solution.nodes.rows(), 3, std::numeric_limits<double>::quiet_NaN())});
        } else if (is_displacement) {
            solution.steps.back().displacement.row(rows.row(lines.integer(0, "a node's number"), lines.where())) =
                lines.position(1);
        }
    }
    return solution;
}

}  // namespace palpate::mesh
