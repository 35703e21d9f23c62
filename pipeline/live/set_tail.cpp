#include "pipeline/live/set_tail.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "identify/measurements/files/set_description.h"
#include "identify/measurements/files/tables.h"
#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"

namespace palpate::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds quiet{250};  // after which a state is taken to be whole

std::vector<std::string> cells_of_row(const std::string& row, char separator) {
    std::vector<std::string> cells;
    std::istringstream in(row);
    for (std::string cell; std::getline(in, cell, separator);) cells.push_back(cell);
    return cells;
}

/// "Time [s]" is time.
std::string column_name(std::string cell) {
    cell = cell.substr(0, cell.find('['));
    std::erase_if(cell, [](char c) { return c <= ' ' || c == '"' || static_cast<unsigned char>(c) > 126; });
    std::ranges::transform(cell, cell.begin(), [](char c) { return static_cast<char>(std::tolower(c)); });
    return cell;
}

/// A folder of its own for what one state's rows are read from.
class Scratch {
public:
    Scratch() {
        std::string path = (fs::temp_directory_path() / "palpate-XXXXXX").string();
        if (mkdtemp(path.data()) == nullptr) throw IoError(path + ": cannot be made");
        folder = path;
    }
    ~Scratch() {
        std::error_code ignored;
        fs::remove_all(folder, ignored);
    }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;
    fs::path folder;
};

}  // namespace

SetTail::SetTail(const fs::path& folder) : folder_(fs::is_directory(folder) ? folder : folder.parent_path()) {
    probes_.file = folder_ / "probes.csv";
    positions_.file = folder_ / "positions.csv";
    changed_ = std::chrono::steady_clock::now();
}

/// Appends whole rows to those of their states; false where there are none.
bool SetTail::read_more(Table& table, std::string Pending::*rows) {
    std::ifstream in(table.file, std::ios::binary);
    if (!in) throw IoError(table.file.string() + ": cannot be read");
    in.seekg(static_cast<std::streamoff>(table.read));
    std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    const std::size_t end = text.rfind('\n');
    if (end == std::string::npos) return false;
    text.resize(end + 1);
    table.read += text.size();
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        if (!line.empty() && line.back() == '\r') line.pop_back();
        if (line.find_first_not_of(" \t") == std::string::npos || line[line.find_first_not_of(" \t")] == '#') continue;
        if (table.header.empty()) {
            table.header = line;
            for (const char separator : {';', '\t'}) {
                if (line.find(separator) != std::string::npos) table.separator = separator;
            }
            const std::vector<std::string> columns = cells_of_row(line, table.separator);
            for (std::size_t i = 0; i < columns.size(); ++i) {
                if (column_name(columns[i]) == "probe") table.probe = static_cast<int>(i);
                if (column_name(columns[i]) == "time") table.time = static_cast<int>(i);
            }
            continue;
        }
        std::vector<std::string> cells = cells_of_row(line, table.separator);
        cells.resize(std::max<std::size_t>(cells.size(), std::max(table.probe, table.time) + 1));
        const auto value = [&](int column) {
            std::string cell = column >= 0 ? cells[column] : "";
            if (table.separator != ',') std::ranges::replace(cell, ',', '.');
            return std::strtod(cell.c_str(), nullptr);
        };
        const identify::StateName name{static_cast<int>(value(table.probe)), value(table.time)};
        const auto [entry, is_new] = pending_.try_emplace(name);
        if (is_new) order_.push_back(name);
        entry->second.*rows += line + "\n";
        if (&table == &positions_) last_ = name;
    }
    return true;
}

/// By the reader of whole sets, so that units, decimal commas and messages are its own.
void SetTail::parse(const Pending& rows, News& news) const {
    const Scratch scratch;
    mesh::write_text(scratch.folder / "probes.csv", probes_.header + "\n" + rows.probes);
    mesh::write_text(scratch.folder / "positions.csv", positions_.header + "\n" + rows.positions);
    try {
        identify::MeasurementSet set;
        const identify::SetDescription description = identify::read_set_description(folder_ / "set.yaml", set);
        identify::TableReader reader(set, description.units);
        reader.read_probes(scratch.folder / "probes.csv");
        reader.read_markers(folder_ / "markers.csv");
        reader.read_positions(scratch.folder / "positions.csv");
        for (identify::LoadState& state : set.states) news.states.push_back(std::move(state));
    } catch (const InvalidInput& fault) {
        std::string words = fault.what();
        const std::string own = scratch.folder.string();
        for (std::size_t at = words.find(own); at != std::string::npos; at = words.find(own)) {
            words.replace(at, own.size(), folder_.string());
        }
        news.faults.push_back(
            fmt::format("among the rows '{}': {}", rows.positions.substr(0, rows.positions.find('\n')), words));
    }
}

SetTail::News SetTail::poll() {
    const auto now = std::chrono::steady_clock::now();
    const bool more_loads = read_more(probes_, &Pending::probes), more = read_more(positions_, &Pending::positions);
    if (more_loads || more) changed_ = now;
    const bool is_quiet = now - changed_ >= quiet;
    News news;
    std::erase_if(order_, [&](const identify::StateName& name) {
        const auto entry = pending_.find(name);
        const Pending& rows = entry->second;
        if (rows.probes.empty() || rows.positions.empty() || (name == last_ && !is_quiet)) return false;
        parse(rows, news);
        pending_.erase(entry);
        return true;
    });
    return news;
}

}  // namespace palpate::pipeline
