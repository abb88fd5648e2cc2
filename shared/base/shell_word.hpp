// Quotes text as one word of a POSIX shell command.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_BASE_SHELL_WORD_HPP
#define KAZ_SHARED_BASE_SHELL_WORD_HPP

#include <string>
#include <string_view>

namespace kaz {

// Returns `word`. If `word` contains characters with a special meaning to the shell, the result is in single
// quotes.
inline std::string shell_word(const std::string& word) {
  constexpr std::string_view plain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=.,:/@%^";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace kaz

#endif
