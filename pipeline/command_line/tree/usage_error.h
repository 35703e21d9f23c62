#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace palpate::pipeline {

/// What is wrong with a command line, in the words of all other messages: what was given, what is allowed, what to do.
/// @param arguments as they were typed, without the program's name
std::string usage_error(const CLI::App& app, const CLI::ParseError& error, const std::vector<std::string>& arguments);

}  // namespace palpate::pipeline
