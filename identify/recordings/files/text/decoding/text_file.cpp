#include "identify/recordings/files/text/decoding/text_file.h"

#include <fmt/format.h>

#include <utility>

namespace palpate::identify {

TextFile::TextFile(std::filesystem::path file, std::string text, std::string encoding, const FileMap& map)
    : file_(std::move(file)), text_(std::move(text)), encoding_(std::move(encoding)) {
    for (std::string_view rest = text_; !rest.empty();) {
        const std::size_t end = std::min(rest.find('\n'), rest.size());
        lines_.push_back(rest.substr(0, end));
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    dialect_ = sniff_dialect(lines_, map);
}

std::string TextFile::where(int i) const { return fmt::format("{}, line {}", file_.filename().string(), i + 1); }

std::vector<std::string> TextFile::notes() const {
    std::vector<std::string> notes{
        fmt::format("{}, cells separated by {}", encoding_, delimiter_in_words(dialect_.delimiter))};
    if (dialect_.decimal == ',') notes.emplace_back("decimal comma");
    if (dialect_.thousands != '\0') notes.push_back(fmt::format("thousands separated by '{}'", dialect_.thousands));
    return notes;
}

}  // namespace palpate::identify
