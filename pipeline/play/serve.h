#pragma once

#include <functional>
#include <string>

namespace palpate::pipeline {

/// Serves one page at http://127.0.0.1:port/ until the program is told to end (Ctrl-C). Nobody but this machine is
/// answered, and only under its own names. `port`: 0 takes a free one. `ready` is told the port once it listens.
/// @throws InvalidInput when the port is in use.
void serve(const std::string& page, int port, const std::function<void(int port)>& ready);

}  // namespace palpate::pipeline
