// Result<T>, the return type of C++ functions that can fail: a value, or an error with message and kind.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_BASE_RESULT_HPP
#define KAZ_SHARED_BASE_RESULT_HPP

#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <tl/expected.hpp>

namespace kaz {

// Kind of an error. The value is the exit status of a command (docs/reference/output.md).
enum class Fault {
  failed = 1,         // the task failed: ball not caught, verify mismatch
  usage = 2,          // wrong options, unusable input file
  environment = 3,    // no such port, port lost, no reply, no display
  interrupted = 128,  // exit status 128 plus the signal's number: 130 after Ctrl-C
};

// An error. `message` is one sentence: what failed, where (file, line, port), and what to do. No trailing
// newline.
struct Error {
  Fault fault = Fault::environment;
  std::string message;
  bool disk_full = false;
  // Further lines for users, such as likely causes. Programs print them below the message.
  std::vector<std::string> details = {};
};

// Returns the message and the details. Each detail is a line that begins with two spaces.
inline std::string full_text(const Error& error) {
  std::string text = error.message;
  for (const std::string& detail : error.details) text += "\n  " + detail;
  return text;
}

template <class T>
using Result = tl::expected<T, Error>;

// Returns an error as a failed Result of any type.
inline tl::unexpected<Error> fail(Fault fault, std::string message) {
  return tl::unexpected<Error>(Error{fault, std::move(message)});
}

// Returns an error with Fault::environment. Libraries use this function if the right Fault depends on the
// command. Examples are the image parsers and the emulator. The caller of the library then replaces
// Fault::environment with the right Fault.
inline tl::unexpected<Error> fail(std::string message) {
  return tl::unexpected<Error>(Error{.message = std::move(message)});
}

namespace try_detail {

// Returns the value of a successful result, copied from an lvalue or moved from an rvalue.
template <class T, class E>
T value_of(const tl::expected<T, E>& result) {
  if constexpr (!std::is_void_v<T>) return *result;
}
template <class T, class E>
T value_of(tl::expected<T, E>&& result) {
  if constexpr (!std::is_void_v<T>) return *std::move(result);
}

}  // namespace try_detail

}  // namespace kaz

// Evaluates to the value of a Result. If the Result is an error, the enclosing function or lambda returns
// this error. The return type of the enclosing function or lambda must be Result<T> with any T.
// Examples:
//
//   const auto image = KAZ_TRY(load_image(path));  // Result<Image>: image is an Image
//   KAZ_TRY(robot.enable());                       // Result<void>, or any Result whose value is not used
//
// KAZ_TRY evaluates the expression once. Use KAZ_TRY only as a complete initializer or as a complete
// statement, as in the two examples. In a larger expression, the return could skip destructors of temporary
// objects. KAZ_TRY uses a statement expression, an extension of GCC and clang.
#define KAZ_TRY(...) KAZ_TRY_NUMBERED(__COUNTER__, __VA_ARGS__)
#define KAZ_TRY_NUMBERED(number, ...) KAZ_TRY_JOINED(number, __VA_ARGS__)
#define KAZ_TRY_JOINED(number, ...) KAZ_TRY_NAMED(kaz_try_##number, __VA_ARGS__)
#define KAZ_TRY_NAMED(name, ...)                                                  \
  __extension__({                                                                 \
    auto&& name = (__VA_ARGS__);                                                  \
    if (!name) return tl::unexpected(std::forward<decltype(name)>(name).error()); \
    ::kaz::try_detail::value_of(std::forward<decltype(name)>(name));              \
  })

#endif
