#pragma once

#include <stdexcept>

namespace palpate {

/// Something that the user can mend: the message names file and line or element, the value, what is
/// allowed and what to do. Exit code 3.
struct InvalidInput : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A computation that did not come to a result. Exit code 4.
struct SolverFailure : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A limit of time or memory was reached: a second try comes no further.
struct LimitReached : SolverFailure {
    using SolverFailure::SolverFailure;
};

/// A file that cannot be opened, read or written. Exit code 3.
struct IoError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

}  // namespace palpate
