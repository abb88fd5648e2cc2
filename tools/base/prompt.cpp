// Questions to whoever sits at the keyboard.
// SPDX-License-Identifier: Apache-2.0
#include "tools/base/prompt.h"

#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>

namespace kaz::tools {

// Not by std::cin: Ctrl-C has to end the wait.
Result<std::string> prompt_user(const std::string& prompt, const host::Interrupt& interrupt,
                                const std::string& nobody) {
  std::fprintf(stderr, "\n%s: ", prompt.c_str());
  std::string line;
  for (char letter = 0; letter != '\n';) {
    pollfd watched[2] = {{STDIN_FILENO, POLLIN, 0}, {interrupt.descriptor(), POLLIN, 0}};
    const int ready = poll(watched, 2, -1);
    if (interrupt.requested()) return tl::unexpected(host::Interrupt::error());
    if (ready < 0 && errno == EINTR) continue;
    if (ready < 0 || ::read(STDIN_FILENO, &letter, 1) != 1) return fail(Fault::usage, nobody);
    if (letter != '\n') line += letter;
  }
  return line;
}

}  // namespace kaz::tools
