#pragma once

#include <gtest/gtest.h>

#include <initializer_list>
#include <string>

#include "mesh/errors.h"

namespace palpate {

/// What `action` says when it throws an Error; "" when it does not throw.
template <class Error = InvalidInput, class Action>
std::string message_of(Action&& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

/// Does a message hold all of these words?
inline ::testing::AssertionResult says(const std::string& message, std::initializer_list<const char*> words) {
    if (message.empty()) return ::testing::AssertionFailure() << "nothing was refused";
    for (const char* word : words)
        if (message.find(word) == std::string::npos)
            return ::testing::AssertionFailure() << "'" << word << "' is not in: " << message;
    return ::testing::AssertionSuccess();
}

}  // namespace palpate
