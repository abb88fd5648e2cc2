// Lets a shared module contain Debian's libasmjit.a.
// SPDX-License-Identifier: Apache-2.0
//
// One of that archive's objects, which prints failed assertions, refers to `stderr` as only executables may.
// The linker takes this variable for it (--wrap=stderr in CMakeLists.txt).
#include <cstdio>

extern "C" {
__attribute__((visibility("hidden"))) extern FILE* __wrap_stderr;  // NOLINT
extern FILE* __real_stderr;                                        // NOLINT
FILE* __wrap_stderr = nullptr;                                     // NOLINT
}

namespace {

__attribute__((constructor(101))) void set_stderr() {
  __wrap_stderr = __real_stderr;
}

}  // namespace
