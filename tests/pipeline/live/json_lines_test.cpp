#include "pipeline/live/json_lines.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

TEST(UnixSocket, StandsInForOneThatWasLeftAndForNothingElse) {
    const TemporaryFolder folder;
    mesh::write_text(folder / "table.csv", "1\n");
    EXPECT_NE(message_of([&] { unix_socket(folder / "table.csv"); }).find("is no socket"), std::string::npos);
    EXPECT_NE(message_of([&] { unix_socket(folder / std::string(200, 'a')); }).find("shorter"), std::string::npos);
    EXPECT_NE(message_of<IoError>([&] { unix_socket(folder / "none/rig.sock"); }).find("none/rig.sock"),
              std::string::npos);
    {
        const auto listening = unix_socket(folder / "rig.sock");
        EXPECT_NE(message_of([&] { unix_socket(folder / "rig.sock"); }).find("another program listens"),
                  std::string::npos);
    }
    {  // as a program leaves it that is killed
        const int left = ::socket(AF_UNIX, SOCK_STREAM, 0);
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        (folder / "rig.sock").string().copy(address.sun_path, sizeof(address.sun_path) - 1);
        ASSERT_EQ(::bind(left, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
        ::close(left);
    }
    EXPECT_NO_THROW(unix_socket(folder / "rig.sock"));
}

}  // namespace
}  // namespace palpate::pipeline
