#include "mesh/formats/deck/keyword_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <utility>

#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "mesh/text/words.h"

namespace palpate::mesh {
namespace {

namespace fs = std::filesystem;

std::string_view without_spaces(std::string_view text) {
    constexpr const char* blanks = " \t\r";
    const std::size_t from = text.find_first_not_of(blanks);
    if (from == std::string_view::npos) return {};
    return text.substr(from, text.find_last_not_of(blanks) - from + 1);
}

std::string in_capitals(std::string_view text) {
    std::string capitals(text);
    std::ranges::transform(capitals, capitals.begin(), [](unsigned char c) { return std::toupper(c); });
    return capitals;
}

std::vector<std::string_view> parts_of(std::string_view line) {
    std::vector<std::string_view> parts;
    while (true) {
        const std::size_t comma = line.find(',');
        parts.push_back(without_spaces(line.substr(0, comma)));
        if (comma == std::string_view::npos) break;
        line.remove_prefix(comma + 1);
    }
    if (parts.back().empty()) parts.pop_back();
    return parts;
}

class Lines {
public:
    Lines(const fs::path& file, std::vector<fs::path>& files) : root_(file), files_(files) {}

    std::vector<KeywordLine> execute() {
        read(root_, 0);
        return std::move(lines_);
    }

private:
    void read(const fs::path& file, int depth) {
        constexpr int deepest = 10;
        if (depth > deepest)
            throw InvalidInput(
                fmt::format("{}: includes files {} deep; does one include itself?", root_.string(), depth));
        // A file that is included twice includes its own twice: what is read grows as a power of the depth.
        constexpr int most_readings = 1000;
        constexpr double most_bytes = 4e9;
        const std::string content = read_text(file);
        bytes_ += static_cast<double>(content.size());
        if (++readings_ > most_readings || bytes_ > most_bytes)
            throw InvalidInput(fmt::format(
                "{}: its includes name {} files and {:.3g} MB by now; up to {} and {:g} MB are allowed. Include each "
                "file once.",
                root_.string(), readings_, bytes_ / 1e6, most_readings, most_bytes / 1e6));
        if (std::ranges::find(files_, file) == files_.end()) files_.push_back(file);
        std::string_view left = content;
        bool goes_on = false;  // a keyword line that ended with a comma
        for (int number = 1; !left.empty(); ++number) {
            const std::size_t end = left.find('\n');
            const std::string_view line = without_spaces(left.substr(0, end));
            left.remove_prefix(end == std::string_view::npos ? left.size() : end + 1);
            if (line.empty() || line.starts_with("**")) continue;
            const std::string where = fmt::format("{}, line {}", file.string(), number);
            if (goes_on) {
                add_parameters(line, file);
            } else if (line.front() == '*') {
                begin_keyword(line, where, file);
            } else {
                KeywordLine& data = lines_.emplace_back();
                data.where = where;
                for (const std::string_view part : parts_of(line)) data.words.push_back(in_capitals(part));
            }
            goes_on = line.back() == ',' && (goes_on || line.front() == '*');
            if (!goes_on && !included_.empty()) include(where, depth);
        }
    }

    void begin_keyword(std::string_view line, const std::string& where, const fs::path& file) {
        const std::size_t comma = line.find(',');
        KeywordLine& keyword = lines_.emplace_back();
        keyword.where = where;
        keyword.keyword =
            in_capitals(without_spaces(line.substr(1, comma == std::string_view::npos ? comma : comma - 1)));
        if (comma != std::string_view::npos) add_parameters(line.substr(comma + 1), file);
    }

    void add_parameters(std::string_view text, const fs::path& file) {
        KeywordLine& keyword = lines_.back();
        for (const std::string_view part : parts_of(text)) {
            const std::size_t equals = part.find('=');
            const std::string name = in_capitals(without_spaces(part.substr(0, equals)));
            const std::string_view value =
                equals == std::string_view::npos ? std::string_view() : without_spaces(part.substr(equals + 1));
            keyword.parameters[name] = in_capitals(value);
            if (keyword.keyword == "INCLUDE" && name == "INPUT") included_ = file.parent_path() / fs::path(value);
        }
    }

    void include(const std::string& where, int depth) {
        const fs::path file = std::exchange(included_, {});
        const fs::path folder = fs::weakly_canonical(root_.parent_path().empty() ? "." : root_.parent_path());
        const std::string inside = fs::weakly_canonical(file).lexically_relative(folder).string();
        if (inside.empty() || inside.starts_with(".."))
            throw InvalidInput(fmt::format("{}: includes {}, which lies outside the folder {}. Copy it there.", where,
                                           file.string(), folder.string()));
        lines_.pop_back();
        read(file, depth + 1);
    }

    int readings_ = 0;  // of files, each as often as it is included
    double bytes_ = 0;
    fs::path root_, included_;
    std::vector<fs::path>& files_;
    std::vector<KeywordLine> lines_;
};

}  // namespace

std::string KeywordLine::parameter(const std::string& name) const {
    const auto found = parameters.find(name);
    return found == parameters.end() ? "" : found->second;
}

bool KeywordLine::is_number(std::size_t i) const { return i < words.size() && parse_number(words[i]).has_value(); }

double KeywordLine::number(std::size_t i, std::string_view what) const {
    if (i >= words.size()) throw InvalidInput(fmt::format("{}: ends where {} should stand.", where, what));
    if (const auto value = parse_number(words[i])) return *value;
    throw InvalidInput(fmt::format("{}: {} is not {}, a finite number.", where, cited(words[i]), what));
}

std::int64_t KeywordLine::integer(std::size_t i, std::string_view what) const {
    if (i >= words.size()) throw InvalidInput(fmt::format("{}: ends where {} should stand.", where, what));
    std::int64_t value = 0;
    const char* end = words[i].data() + words[i].size();
    const auto result = std::from_chars(words[i].data(), end, value);
    if (result.ec != std::errc() || result.ptr != end)
        throw InvalidInput(fmt::format("{}: {} is not {}, a whole number.", where, cited(words[i]), what));
    return value;
}

std::vector<KeywordLine> read_keyword_lines(const fs::path& file, std::vector<fs::path>& files) {
    return Lines(file, files).execute();
}

}  // namespace palpate::mesh
