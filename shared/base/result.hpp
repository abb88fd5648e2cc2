// The error type of the C++ side: what went wrong, in one sentence, and whose fault it is.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_BASE_RESULT_HPP
#define KAZ_SHARED_BASE_RESULT_HPP

#include <string>
#include <type_traits>
#include <utility>

#include <tl/expected.hpp>

namespace kaz {

// The command line turns a fault into its exit code (the value here; docs/reference/exit-status.md).
enum class Fault {
  failed = 1,         // the task itself did not succeed: ball not caught, verify mismatch
  usage = 2,          // wrong options, unusable input file
  environment = 3,    // no such port, port lost, no answer, no display
  interrupted = 128,  // by a signal, whose number is added: 130 after Ctrl-C
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

namespace try_detail {

// The value of a result that has one: copied from an lvalue, moved from an rvalue.
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

// The value of a Result; where it is an error, returns that error from the enclosing function or lambda,
// whose return type must be a Result of any type:
//
//   const auto image = KAZ_TRY(load_image(path));  // Result<Image>: image is an Image
//   KAZ_TRY(robot.enable());                       // Result<void>, or a value that is not needed
//
// The expression is evaluated once. Write it as a whole initializer or statement as above, not as a part of
// a larger expression, whose temporaries a return from its middle may leave undestroyed. (GCC and clang: a
// statement expression.)
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
