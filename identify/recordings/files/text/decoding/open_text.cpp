#include "identify/recordings/files/text/decoding/open_text.h"

#include <fmt/format.h>

#include <algorithm>

#include "identify/recordings/files/text/decoding/encoding.h"
#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "mesh/text/words.h"

namespace palpate::identify {

std::unique_ptr<TextFile> try_text(const std::filesystem::path& file, const std::string& bytes, const FileMap& map) {
    auto text = decode_text(bytes, map.encoding);
    if (!text) return nullptr;
    return std::make_unique<TextFile>(file, std::move(text->text), std::move(text->encoding), map);
}

std::unique_ptr<TextFile> open_text(const std::filesystem::path& file, const FileMap& map) {
    auto text = try_text(file, mesh::read_text(file), map);
    if (!text)
        throw InvalidInput(fmt::format("{}: this is no text: it holds bytes that no text has. Export it as CSV.",
                                       file.filename().string()));
    return text;
}

std::filesystem::path file_beside(const std::filesystem::path& file, const std::string& name) {
    const std::filesystem::path path = name;
    if (name.empty() || path.is_absolute() || std::ranges::find(path, "..") != path.end())
        throw InvalidInput(
            fmt::format("map.yaml: the file {} does not lie in the folder of {}. Put it there, and give its "
                        "name alone.",
                        mesh::cited(name), file.filename().string()));
    return file.parent_path() / path;
}

}  // namespace palpate::identify
