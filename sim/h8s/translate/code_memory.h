// Memory for host code. No page is writable and executable at the same time.
// SPDX-License-Identifier: Apache-2.0
//
// asmjit's JitRuntime maps its memory writable and executable. With its dual mapping, JitRuntime maps the
// memory twice: one mapping is executable, the other is writable. An attacker who can write to any address
// can inject code through the writable mapping. In this class, each page has one mapping. Before the code
// runs, mprotect makes this mapping read-only and executable. docs/explanation/emulator.md states the cost of
// mprotect.
#pragma once

#include <cstddef>

#include <asmjit/core.h>

namespace kaz::h8s::translate {

// Owns one range of addresses. Not thread-safe.
class CodeMemory {
 public:
  // Size of the address range, bytes. Pages are committed when code is added.
  static constexpr std::size_t kSize = std::size_t{16} << 20;

  CodeMemory() = default;
  ~CodeMemory();
  CodeMemory(const CodeMemory&) = delete;
  CodeMemory& operator=(const CodeMemory&) = delete;

  // Appends finished code and returns its address. Returns null if asmjit fails, the range is full, or a
  // security policy forbids executable memory. Call clear() after a failure, because a failure can leave
  // pages of earlier code without execute permission. Must not be called while code of this memory runs.
  const void* add(asmjit::CodeHolder& code);
  // Discards all code. Code that is added later reuses the memory of the discarded code.
  void clear() { used_ = 0; }

 private:
  std::byte* begin_ = nullptr;
  std::size_t used_ = 0;  // bytes
};

}  // namespace kaz::h8s::translate
