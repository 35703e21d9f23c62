// The same readers, fed by libFuzzer, which looks for inputs that reach code no other has reached. PALPATE_READER names
// one; the sound input is written to the folder PALPATE_CORPUS, to start from.
//   cmake --preset fuzz && cmake --build --preset fuzz
//   PALPATE_READER=frd PALPATE_CORPUS=corpus build-fuzz/fuzz_guided corpus -runs=1000000

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "tests/fuzz/readers.h"
#include "tests/temporary_folder.h"

namespace palpate::fuzz {
namespace {

namespace fs = std::filesystem;

/// The chosen reader in a folder of its own, which goes when the program ends.
struct Fed {
    Reader reader;
    std::unique_ptr<TemporaryFolder> folder = std::make_unique<TemporaryFolder>();
    fs::path file;

    void feed(const std::string& input) const {
        mesh::write_text(file, input);
        try {
            reader.read(folder->path());
        } catch (const InvalidInput&) {
        } catch (const IoError&) {
        }
    }
};

std::unique_ptr<Fed> fed;

std::string asked(const char* variable) {
    const char* value = std::getenv(variable);
    return value != nullptr ? value : "";
}

void choose() {
    const std::vector<Reader> readers = all_readers();
    const std::string name = asked("PALPATE_READER");
    const auto found = std::ranges::find_if(readers, [&](const Reader& reader) { return name == reader.name; });
    if (found == readers.end()) {
        std::fprintf(stderr, "PALPATE_READER is '%s'; allowed are:", name.c_str());
        for (const Reader& reader : readers) std::fprintf(stderr, " %s", reader.name);
        std::fprintf(stderr, "\n");
        std::exit(2);
    }
    fed = std::make_unique<Fed>(Fed{*found});
    fed->file = found->make(fed->folder->path());
    if (const fs::path corpus = asked("PALPATE_CORPUS"); !corpus.empty()) {
        fs::create_directories(corpus);
        mesh::write_text(corpus / "sound", mesh::read_text(fed->file));
    }
}

}  // namespace
}  // namespace palpate::fuzz

extern "C" int LLVMFuzzerInitialize(int*, char***) {
    palpate::fuzz::choose();
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    palpate::fuzz::fed->feed(std::string(reinterpret_cast<const char*>(data), size));
    return 0;
}
