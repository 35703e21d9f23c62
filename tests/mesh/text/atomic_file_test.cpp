#include "mesh/text/atomic_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <thread>
#include <vector>

#include "mesh/errors.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::mesh {
namespace {

namespace fs = std::filesystem;

int entries(const fs::path& folder) {
    return static_cast<int>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(WriteWhole, MakesFoldersAndReplacesTheFile) {
    const TemporaryFolder folder;
    write_text(folder / "a/b/text.txt", "first");
    write_text(folder / "a/b/text.txt", "second\n");
    EXPECT_EQ(read_text(folder / "a/b/text.txt"), "second\n");
    EXPECT_EQ(entries(folder / "a/b"), 1);
}

TEST(WriteWhole, LeavesTheOldFileAndNothingElseWhenWritingFails) {
    const TemporaryFolder folder;
    const fs::path target = folder.write("text.txt", "old");
    EXPECT_THROW(write_whole(target,
                             [](const fs::path& temporary) {
                                 write_text(temporary, "half");
                                 throw std::runtime_error("the power failed");
                             }),
                 std::runtime_error);
    EXPECT_EQ(read_text(target), "old");
    EXPECT_EQ(entries(folder.path()), 1);
}

TEST(WriteWhole, GivesAFileBesideTheTargetWithItsExtension) {
    const TemporaryFolder folder;
    write_whole(folder / "mesh.vtu", [&](const fs::path& temporary) {
        EXPECT_EQ(temporary.parent_path(), folder.path());
        EXPECT_EQ(temporary.extension(), ".vtu");
        EXPECT_FALSE(fs::exists(folder / "mesh.vtu"));
        write_text(temporary, "x");
    });
    EXPECT_TRUE(fs::exists(folder / "mesh.vtu"));
}

TEST(WriteWhole, OfManyThreadsLeavesOneWholeFile) {
    const TemporaryFolder folder;
    std::vector<std::thread> threads;
    for (char c = 'a'; c < 'i'; ++c)
        threads.emplace_back([&, c] { write_text(folder / "text.txt", std::string(10000, c)); });
    for (auto& thread : threads) thread.join();
    const std::string text = read_text(folder / "text.txt");
    EXPECT_EQ(text, std::string(10000, text.front()));
    EXPECT_EQ(entries(folder.path()), 1);
}

TEST(WriteWhole, SaysWhyItCannot) {
    const TemporaryFolder folder;
    fs::create_directories(folder / "taken");
    EXPECT_TRUE(says(message_of<IoError>([&] { write_text(folder / "taken", "x"); }), {"taken", "a folder"}));
    const fs::path file = folder.write("file", "x");
    EXPECT_TRUE(says(message_of<IoError>([&] { write_text(file / "inside.txt", "x"); }), {"file", "cannot be made"}));
}

TEST(ReadText, SaysWhatIsMissing) {
    const TemporaryFolder folder;
    EXPECT_TRUE(says(message_of<IoError>([&] { read_text(folder / "none.csv"); }), {"none.csv", "no such file"}));
    EXPECT_TRUE(says(message_of<IoError>([&] { read_text(folder.path()); }), {"is a folder"}));
}

}  // namespace
}  // namespace palpate::mesh
