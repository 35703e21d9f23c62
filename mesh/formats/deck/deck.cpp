#include "mesh/formats/deck/deck.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "mesh/errors.h"
#include "mesh/formats/deck/keyword_lines.h"
#include "mesh/text/words.h"

namespace palpate::mesh {
namespace {

/// "PART-1-1.12" is 12: a flat mesh has one instance.
std::string without_instance(const std::string& word) {
    const std::size_t dot = word.rfind('.');
    if (dot == std::string::npos || parse_number(word)) return word;
    return word.substr(dot + 1);
}

class DeckReader {
public:
    explicit DeckReader(const std::filesystem::path& file) { deck_.file = file; }

    Deck execute() {
        const std::vector<KeywordLine> lines = read_keyword_lines(deck_.file, deck_.files);
        for (const KeywordLine& line : lines) line.keyword.empty() ? read_data(line) : begin(line);
        if (!open_cell_.empty())
            throw InvalidInput(fmt::format("{}: the last element ends after {} of {} nodes.", deck_.file.string(),
                                           open_cell_.size() - 1, cell_nodes_));
        finish();
        return std::move(deck_);
    }

private:
    using Nodes = std::set<std::int64_t>;

    void begin(const KeywordLine& line) {
        now_ = &line;
        const std::string& keyword = line.keyword;
        read_ = nullptr;
        if (keyword == "NODE") {
            read_ = &DeckReader::read_node;
        } else if (keyword == "ELEMENT") {
            begin_elements();
        } else if (keyword == "NSET" || keyword == "ELSET") {
            read_ = &DeckReader::read_set;
        } else if (keyword == "BOUNDARY") {
            read_ = &DeckReader::read_boundary;
        } else if (keyword == "MATERIAL") {
            ++materials_;
        } else if (keyword == "ELASTIC") {
            const std::string type = line.parameter("TYPE");
            if (type.empty() || type == "ISO" || type == "ISOTROPIC") read_ = &DeckReader::read_elastic;
        } else if (keyword == "DENSITY") {
            read_ = &DeckReader::read_density;
        } else if (keyword == "INSTANCE") {
            if (++instances_ > 1)
                throw InvalidInput(
                    fmt::format("{}: a second instance; write the assembly as one flat mesh.", line.where));
            read_ = &DeckReader::refuse_moved_instance;
        } else {
            begin_load();
        }
    }

    void begin_load() {
        const std::string& keyword = now_->keyword;
        if (keyword == "STEP") {
            begin_step();
            touched_.clear();
        } else if (deck_.steps.empty()) {
            return;
        } else if (keyword == "CLOAD") {
            if (now_->parameter("OP") == "NEW") step().forces.clear();
            read_ = &DeckReader::read_force;
        } else if (keyword == "DLOAD") {
            if (now_->parameter("OP") == "NEW") forget_body_forces();
            read_ = &DeckReader::read_body_force;
        } else if (keyword == "DSLOAD" || keyword == "TEMPERATURE" || keyword == "CFLUX") {
            step().others.push_back(fmt::format("*{}, {}", keyword, now_->where));
        }
    }

    /// A step goes on with the loads of the step before.
    void begin_step() {
        constexpr std::size_t most_loads = 2'000'000;  // 200 MB
        if (!deck_.steps.empty()) loads_ += 1 + step().forces.size() + step().others.size();
        if (loads_ > most_loads)
            throw InvalidInput(fmt::format(
                "{}: step {}; the steps hold {} loads by now, those that go on counted in each, and up to {} are "
                "allowed. Put fewer steps into a file, or spread a load over fewer nodes.",
                now_->where, deck_.steps.size() + 1, loads_, most_loads));
        deck_.steps.push_back(deck_.steps.empty() ? DeckStep{} : deck_.steps.back());
    }

    DeckStep& step() { return deck_.steps.back(); }

    void forget_body_forces() {
        step().gravity.reset();
        step().others.clear();
    }

    void read_data(const KeywordLine& line) {
        if (read_) (this->*read_)(line);
    }

    void read_node(const KeywordLine& line) {
        const std::int64_t number = line.integer(0, "a node's number");
        deck_.cells.node_numbers.push_back(number);
        Vec3& at = deck_.cells.nodes.emplace_back();
        for (int c = 0; c < 3; ++c) at[c] = line.number(static_cast<std::size_t>(c) + 1, "a coordinate");
        if (const std::string set = now_->parameter("NSET"); !set.empty()) sets_[set].insert(number);
    }

    void begin_elements() {
        const std::string type = now_->parameter("TYPE");
        shape_ = shape_of_type(type);
        if (!shape_) {
            if (type.starts_with("C3D"))
                throw InvalidInput(
                    fmt::format("{}: elements of type {}; C3D4, C3D10, C3D8, C3D20, C3D6, C3D15, C3D5 are allowed.",
                                now_->where, cited(type)));
            left_out_.insert(type);
            return;
        }
        cell_nodes_ = nodes_of_type(type);
        read_ = &DeckReader::read_element;
    }

    /// An element goes on over lines until it has all its nodes.
    void read_element(const KeywordLine& line) {
        for (std::size_t i = 0; i < line.words.size(); ++i)
            open_cell_.push_back(line.integer(i, "an element's or node's number"));
        const auto wanted = static_cast<std::size_t>(cell_nodes_) + 1;
        if (open_cell_.size() < wanted) return;
        if (open_cell_.size() > wanted)
            throw InvalidInput(fmt::format("{}: element {} has {} nodes, its type {}.", line.where, open_cell_.front(),
                                           open_cell_.size() - 1, cell_nodes_));
        deck_.cells.cells.push_back({open_cell_.front(), *shape_, {open_cell_.begin() + 1, open_cell_.end()}});
        if (const std::string set = now_->parameter("ELSET"); !set.empty())
            element_sets_[set].insert(open_cell_.front());
        open_cell_.clear();
    }

    void read_set(const KeywordLine& line) {
        const bool of_nodes = now_->keyword == "NSET";
        auto& sets = of_nodes ? sets_ : element_sets_;
        const std::string name = now_->parameter(now_->keyword);
        if (name.empty()) throw InvalidInput(fmt::format("{}: a set without a name.", now_->where));
        if (now_->parameters.contains("GENERATE")) {
            generate(line, of_nodes, sets[name]);
            return;
        }
        for (std::size_t i = 0; i < line.words.size(); ++i) {
            const std::string word = without_instance(line.words[i]);
            if (const auto found = sets.find(word); found != sets.end()) {
                const Nodes members = found->second;
                sets[name].insert(members.begin(), members.end());
            } else {
                sets[name].insert(line.integer(i, "a number, or a set that stands before this one"));
            }
        }
    }

    /// Of numbers that are there already.
    void generate(const KeywordLine& line, bool of_nodes, Nodes& set) {
        const std::int64_t first = line.integer(0, "the first number"), last = line.integer(1, "the last number");
        const std::int64_t by = line.words.size() > 2 ? line.integer(2, "the step between numbers") : 1;
        if (by < 1) throw InvalidInput(fmt::format("{}: a step of {} between numbers; 1 or more.", line.where, by));
        const auto add = [&](std::int64_t number) {
            if (number >= first && number <= last && (number - first) % by == 0) set.insert(number);
        };
        if (of_nodes) {
            std::ranges::for_each(deck_.cells.node_numbers, add);
        } else {
            for (const Cells::Cell& cell : deck_.cells.cells) add(cell.number);
        }
    }

    /// The nodes that the first word of a line names.
    Nodes named_nodes(const KeywordLine& line) const {
        const std::string word = line.words.empty() ? "" : without_instance(line.words[0]);
        if (const auto found = sets_.find(word); found != sets_.end()) return found->second;
        if (const auto number = parse_integer(word)) return {*number};
        throw InvalidInput(
            fmt::format("{}: {} is neither a node nor a set of nodes that stands before.", line.where, cited(word)));
    }

    void read_boundary(const KeywordLine& line) {
        const Nodes nodes = named_nodes(line);
        std::array<bool, 3> fixed{};
        double value = 0;
        if (line.words.size() > 1 && !line.is_number(1)) {
            if (line.words[1] == "ENCASTRE" || line.words[1] == "PINNED") fixed = {true, true, true};
            if (line.words[1] == "XSYMM") fixed[0] = true;
            if (line.words[1] == "YSYMM") fixed[1] = true;
            if (line.words[1] == "ZSYMM") fixed[2] = true;
        } else {
            const std::int64_t first = line.integer(1, "a direction, 1 to 3");
            const std::int64_t last = line.is_number(2) ? line.integer(2, "a direction, 1 to 3") : first;
            for (std::int64_t d = std::max<std::int64_t>(first, 1); d <= std::min<std::int64_t>(last, 3); ++d)
                fixed[static_cast<std::size_t>(d) - 1] = true;
            if (line.words.size() > 3) value = line.number(3, "a displacement");
        }
        for (const std::int64_t node : nodes)
            for (std::size_t d = 0; d < 3; ++d)
                if (fixed[d]) {
                    fixed_[node][d] = true;
                    if (value != 0) driven_.insert(node);
                }
    }

    void read_force(const KeywordLine& line) {
        const std::int64_t direction = line.integer(1, "a direction, 1 to 3");
        const double value = line.number(2, "a force");
        if (direction < 1 || direction > 3) {
            step().others.push_back(fmt::format("*CLOAD in direction {}, {}", direction, line.where));
            return;
        }
        for (const std::int64_t node : named_nodes(line)) {
            double& force = step().forces.try_emplace(node, Vec3::Zero()).first->second[direction - 1];
            // What an earlier step said no longer holds; what this one says twice adds up.
            if (touched_.insert({node, direction}).second) force = 0;
            force += value;
        }
    }

    void read_body_force(const KeywordLine& line) {
        if (line.words.size() >= 6 && line.words[1] == "GRAV") {
            const Vec3 direction{line.number(3, "a direction"), line.number(4, "a direction"),
                                 line.number(5, "a direction")};
            if (direction.norm() == 0) throw InvalidInput(fmt::format("{}: gravity without a direction.", line.where));
            step().gravity = line.number(2, "an acceleration") * direction.normalized();
        } else {
            step().others.push_back(fmt::format("*DLOAD, {}", line.where));
        }
    }

    void read_elastic(const KeywordLine& line) {
        if (deck_.young) return;  // one for each temperature: the first
        deck_.young = line.number(0, "Young's modulus");
        deck_.poisson = line.number(1, "Poisson's ratio");
    }

    void read_density(const KeywordLine& line) {
        if (!deck_.density) deck_.density = line.number(0, "a density");
    }

    void refuse_moved_instance(const KeywordLine& line) {
        throw InvalidInput(
            fmt::format("{}: an instance that is moved or turned; write the assembly as one flat mesh.", line.where));
    }

    void finish() {
        for (const auto& [node, fixed] : fixed_) {
            const bool is_held = std::ranges::count(fixed, true) == 3 && !driven_.contains(node);
            (is_held ? deck_.held : deck_.held_in_part).insert(node);
        }
        if (materials_ > 1) deck_.young = deck_.poisson = deck_.density = std::nullopt;
        for (const std::string& type : left_out_)
            deck_.notes.push_back(fmt::format("Elements of type {} are no solids: left out.", cited(type)));
    }

    Deck deck_;
    const KeywordLine* now_ = nullptr;                        // the keyword whose data are read
    void (DeckReader::*read_)(const KeywordLine&) = nullptr;  // what reads them; none: they are skipped
    std::optional<CellShape> shape_;
    int cell_nodes_ = 0;
    std::vector<std::int64_t> open_cell_;  // its number, and the nodes so far
    std::map<std::string, Nodes> sets_, element_sets_;
    std::map<std::int64_t, std::array<bool, 3>> fixed_;
    Nodes driven_;                                             // to a displacement that is not zero
    std::set<std::pair<std::int64_t, std::int64_t>> touched_;  // node and direction, in this step
    std::set<std::string> left_out_;
    int materials_ = 0, instances_ = 0;
    std::size_t loads_ = 0;  // of all steps but the last
};

}  // namespace

Deck read_deck(const std::filesystem::path& file) { return DeckReader(file).execute(); }

}  // namespace palpate::mesh
