#include <fmt/format.h>

#include <charconv>
#include <limits>
#include <optional>

#include "mesh/errors.h"
#include "mesh/formats/solution/solution_parts.h"
#include "mesh/text/atomic_file.h"
#include "mesh/text/words.h"

namespace palpate::mesh {
namespace {

/// Solid elements as a .frd file numbers their types. [cgx manual, Element types]
struct FrdType {
    CellShape shape;
    int nodes;
};
std::optional<FrdType> frd_type(int type) {
    switch (type) {
        case 1:
            return FrdType{CellShape::hexahedron, 8};
        case 2:
            return FrdType{CellShape::wedge, 6};
        case 3:
            return FrdType{CellShape::tetrahedron, 4};
        case 4:
            return FrdType{CellShape::hexahedron, 20};
        case 5:
            return FrdType{CellShape::wedge, 15};
        case 6:
            return FrdType{CellShape::tetrahedron, 10};
        default:
            return std::nullopt;
    }
}

/// Blocks of lines in columns of fixed width, which need no blank between them. [cgx manual, Result format]
class FrdReader {
public:
    explicit FrdReader(const std::filesystem::path& file) : content_(read_text(file)) { solution_.file = file; }

    Solution execute() {
        while (next_line()) {
            if (line_.starts_with("    2C")) {
                read_nodes();
            } else if (line_.starts_with("    3C")) {
                read_cells();
            } else if (line_.starts_with("    1PSTEP")) {
                load_step_ = integer(48, 12, "a step's number");
            } else if (line_.starts_with("  100C")) {
                read_results();
            }
        }
        return std::move(solution_);
    }

private:
    bool next_line() {
        if (at_ >= content_.size()) return false;
        const std::size_t end = std::min(content_.find('\n', at_), content_.size());
        line_ = std::string_view(content_).substr(at_, end - at_);
        if (line_.ends_with('\r')) line_.remove_suffix(1);
        at_ = end + 1;
        ++number_;
        return true;
    }

    std::string where() const { return fmt::format("{}, line {}", solution_.file.string(), number_); }

    std::string_view column(std::size_t from, std::size_t width, std::string_view what) const {
        if (line_.size() <= from) throw InvalidInput(fmt::format("{}: ends where {} should stand.", where(), what));
        std::string_view text = line_.substr(from, width);
        while (text.starts_with(' ')) text.remove_prefix(1);
        while (text.ends_with(' ')) text.remove_suffix(1);
        return text;
    }
    int integer(std::size_t from, std::size_t width, std::string_view what) const {
        const std::string_view text = column(from, width, what);
        if (const auto value = parse_integer(text)) return *value;
        throw InvalidInput(fmt::format("{}: {} is not {}, a whole number.", where(), cited(text), what));
    }
    double number(std::size_t from, std::size_t width, std::string_view what) const {
        const std::string_view text = column(from, width, what);
        if (const auto value = parse_number(text)) return *value;
        throw InvalidInput(fmt::format("{}: {} is not {}, a finite number.", where(), cited(text), what));
    }

    /// Digits of a node's or element's number, as the last digit of a block's head tells.
    std::size_t width_of_numbers() const {
        const std::size_t last = line_.find_last_not_of(' ');
        if (line_[last] == '1') return 10;
        if (line_[last] == '0') return 5;
        throw InvalidInput(
            fmt::format("{}: a binary block; let CalculiX write text (*NODE FILE in place of *NODE OUTPUT).", where()));
    }

    /// To the next line of a block, false at its end (" -3").
    bool next_of_block() {
        if (!next_line()) throw InvalidInput(fmt::format("{}: is cut off within a block.", solution_.file.string()));
        return !line_.starts_with(" -3");
    }

    void read_nodes() {
        const std::size_t width = width_of_numbers();
        while (next_of_block()) {
            cells_.node_numbers.push_back(integer(3, width, "a node's number"));
            Vec3& at = cells_.nodes.emplace_back();
            for (std::size_t c = 0; c < 3; ++c)
                at[static_cast<Eigen::Index>(c)] = number(3 + width + 12 * c, 12, "a coordinate");
        }
    }

    void read_cells() {
        const std::size_t width = width_of_numbers();
        Cells::Cell* open = nullptr;
        int wanted = 0;
        while (next_of_block()) {
            if (line_.starts_with(" -1")) {
                const int type = integer(3 + width, 5, "an element's type");
                const auto known = frd_type(type);
                open = nullptr;
                if (!known) continue;  // a shell, a beam
                open =
                    &cells_.cells.emplace_back(Cells::Cell{integer(3, width, "an element's number"), known->shape, {}});
                wanted = known->nodes;
            } else if (line_.starts_with(" -2") && open) {
                for (std::size_t from = 3; from < line_.size() && std::ssize(open->nodes) < wanted; from += width)
                    open->nodes.push_back(integer(from, width, "a node's number"));
            }
        }
        for (const Cells::Cell& cell : cells_.cells)
            if (const auto n = std::ssize(cell.nodes);
                n != nodes_of(cell.shape).all && n != nodes_of(cell.shape).corners)
                throw InvalidInput(
                    fmt::format("{}: element {} has {} nodes, too few for its type.", where(), cell.number, n));
        set_mesh(solution_, cells_);
        rows_.emplace(cells_.node_numbers, solution_.file);
    }

    void read_results() {
        const double time = number(12, 12, "the time");
        const std::size_t width = width_of_numbers();
        bool is_displacement = false;
        while (next_of_block()) {
            if (line_.starts_with(" -4")) {
                is_displacement = column(5, 8, "a result's name") == "DISP";
                if (is_displacement) begin_step(time);
            } else if (is_displacement && line_.starts_with(" -1")) {
                const Eigen::Index row = rows_->row(integer(3, width, "a node's number"), where());
                for (std::size_t c = 0; c < 3; ++c)
                    solution_.steps.back().displacement(row, static_cast<Eigen::Index>(c)) =
                        number(3 + width + 12 * c, 12, "a displacement");
            }
        }
    }

    void begin_step(double time) {
        if (!rows_) throw InvalidInput(fmt::format("{}: displacements before nodes and elements.", where()));
        SolvedStep& step = solution_.steps.emplace_back();
        step.time = time;
        step.load_step = load_step_;
        step.displacement = Points::Constant(solution_.nodes.rows(), 3, std::numeric_limits<double>::quiet_NaN());
    }

    std::string content_;
    std::size_t at_ = 0;
    int number_ = 0, load_step_ = 0;
    std::string_view line_;
    Cells cells_;
    std::optional<NodeRows> rows_;
    Solution solution_;
};

}  // namespace

Solution read_frd(const std::filesystem::path& file) { return FrdReader(file).execute(); }

}  // namespace palpate::mesh
