// _exit() and _Exit() of this program: a plug-in that calls them does not skip what has to be done before.
// SPDX-License-Identifier: Apache-2.0
//
// They are exported (exports.txt), so that a plug-in's calls come here and not to the C library.
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdlib>

#include "tools/app/session/plugin_guard.h"

extern "C" {

[[noreturn]] void _exit(int status) {
  kaz::tools::before_exit("_exit", status);
  while (true) ::syscall(SYS_exit_group, status);
}

[[noreturn]] void _Exit(int status) noexcept {
  kaz::tools::before_exit("_Exit", status);
  while (true) ::syscall(SYS_exit_group, status);
}

}  // extern "C"
