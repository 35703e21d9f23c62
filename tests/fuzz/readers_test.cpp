// Whatever stands in a file, a reader reads it or says what is wrong: it neither crashes, nor hangs, nor asks for all
// the memory. Sound files, broken by chance, thousands of times; PALPATE_FUZZ=1000000 for as many of each.

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <fstream>

#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "tests/fuzz/mutations.h"
#include "tests/fuzz/readers.h"
#include "tests/sanitizers.h"
#include "tests/temporary_folder.h"

namespace palpate::fuzz {

/// In the names of the tests.
void PrintTo(const Reader& reader, std::ostream* out) { *out << reader.name; }

namespace {

namespace fs = std::filesystem;

constexpr double gigabyte = 1 << 30;
constexpr double most_memory = 6;  // [GB] of address space beyond what is in use when a reader begins

class Readers : public testing::TestWithParam<Reader> {};

/// For as long as it lives, no more than so much memory beyond what is in use: a file that announces more is to be
/// refused, not believed. Not under the sanitizers, whose shadow takes terabytes of address space.
class MemoryLimit {
public:
    MemoryLimit() {
#ifndef PALPATE_ADDRESS_SANITIZER
        std::ifstream statm("/proc/self/statm");
        double pages = 0;
        statm >> pages;
        getrlimit(RLIMIT_AS, &before_);
        rlimit limit = before_;
        limit.rlim_cur = static_cast<rlim_t>(pages * 4096 + most_memory * gigabyte);
        setrlimit(RLIMIT_AS, &limit);
#endif
    }
    ~MemoryLimit() {
#ifndef PALPATE_ADDRESS_SANITIZER
        setrlimit(RLIMIT_AS, &before_);
#endif
    }
    MemoryLimit(const MemoryLimit&) = delete;
    MemoryLimit& operator=(const MemoryLimit&) = delete;

private:
    rlimit before_{};
};

TEST_P(Readers, ReadOrRefuse) {
    const TemporaryFolder folder;
    const fs::path file = GetParam().make(folder.path());
    const std::string sound = mesh::read_text(file);
    ASSERT_NO_THROW(GetParam().read(folder.path()));

    std::mt19937_64 random(1);
    const MemoryLimit limit;
    int refused = 0;
    for (int i = 0; i < inputs(600); ++i) {
        const std::string broken = mutated(sound, random);
        mesh::write_text(file, broken);
        try {
            GetParam().read(folder.path());
        } catch (const InvalidInput& e) {
            ++refused;
            EXPECT_GT(std::string(e.what()).size(), 10u);
        } catch (const IoError&) {
            ++refused;
        } catch (const std::exception& e) {
            const fs::path kept = fs::temp_directory_path() / ("palpate-broken-" + file.filename().string());
            mesh::write_text(kept, broken);
            FAIL() << e.what() << " instead of a refusal, at input " << i << ": " << kept;
        }
    }
    RecordProperty("refused", refused);
    EXPECT_GT(refused, inputs(600) / 20);  // mutations that nothing notices would test nothing
}

INSTANTIATE_TEST_SUITE_P(Of, Readers, testing::ValuesIn(all_readers()), [](const testing::TestParamInfo<Reader>& each) {
    std::string name = each.param.name;
    std::ranges::replace(name, '.', '_');
    return name;
});

}  // namespace
}  // namespace palpate::fuzz
