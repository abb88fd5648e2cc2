// The error type of the C++ side: what went wrong, in one sentence, and whose fault it is.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_BASE_RESULT_HPP
#define KAZ_SHARED_BASE_RESULT_HPP

#include <string>
#include <utility>

#include <tl/expected.hpp>

namespace kaz {

// The command line turns a fault into its exit code (the value here).
enum class Fault {
  failed = 1,       // the task itself did not succeed: ball not caught, verify mismatch
  usage = 2,        // wrong options, unusable input file
  environment = 3,  // no such port, port lost, no answer, no display
};

// One sentence: what went wrong, where (file, line, port), and what to do about it. No trailing newline.
struct Error {
  Fault fault = Fault::environment;
  std::string message;
};

template <class T>
using Result = tl::expected<T, Error>;

inline tl::unexpected<Error> fail(Fault fault, std::string message) {
  return tl::unexpected<Error>(Error{fault, std::move(message)});
}

// For libraries that do not know whose fault it is, such as the readers of images and the emulator: the
// caller passes the message on with a fault of its own.
inline tl::unexpected<Error> fail(std::string message) {
  return tl::unexpected<Error>(Error{.message = std::move(message)});
}

}  // namespace kaz

#endif
