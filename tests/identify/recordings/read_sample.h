#pragma once

#include <algorithm>
#include <string>

#include "identify/recordings/files/read_recordings.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::identify {

/// The first recording of a file that holds this.
inline Recording read_sample(const std::string& content, const FileMap& map = {}) {
    const TemporaryFolder folder;
    return read_recordings(folder.write("run.csv", content), map).at(0);
}

/// That of a file that holds this and no other.
inline Recording only_recording(const std::string& name, const std::string& content) {
    const TemporaryFolder folder;
    const std::vector<Recording> recordings = read_recordings(folder.write(name, content));
    EXPECT_EQ(recordings.size(), 1U);
    return recordings.at(0);
}

/// What is said of a file that holds this; "": it is read.
inline std::string refusal_of(const std::string& content, const FileMap& map = {}) {
    return message_of([&] { read_sample(content, map); });
}

/// Does a note of the recording hold this?
inline bool notes_tell(const Recording& recording, const std::string& word) {
    return std::ranges::any_of(recording.notes, [&](const auto& note) { return note.find(word) != std::string::npos; });
}

}  // namespace palpate::identify
