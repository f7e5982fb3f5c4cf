// The two ways groundloop fails: bad input, which the user can mend, and a broken internal promise.
#pragma once

#include <stdexcept>
#include <string>

namespace groundloop {

/// Bad input or usage. The text names the file, the record or line, what is wrong and what would
/// mend it; the command prints it in one line and exits with 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The user asked to stop (Ctrl-C). The command leaves a resumable session and exits with 130.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
};

/// Throws std::logic_error naming `what` unless `condition` holds: a failed internal check, exit
/// code 1.
inline void check(bool condition, const char* what) {
  if (!condition) throw std::logic_error(std::string("internal check failed: ") + what);
}

}  // namespace groundloop
