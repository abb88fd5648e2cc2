// The error type of the emulator library: it is usable without the rest of the tree.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace kaz::h8s {

// One sentence: what is wrong, in which file and line or offset, and what to do. No trailing
// newline.
struct Error {
  std::string message;
};

template <class T>
using Result = tl::expected<T, Error>;

inline tl::unexpected<Error> fail(std::string message) {
  return tl::unexpected<Error>(Error{std::move(message)});
}

}  // namespace kaz::h8s
