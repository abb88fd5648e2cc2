// Memory for host code: written, then executed, never both at once.
// SPDX-License-Identifier: Apache-2.0
//
// asmjit's own JitRuntime maps its memory writable and executable. Its option of two mappings of the same
// memory keeps each of them from being both, but leaves the writable one there for good: whoever can write
// anywhere can still write code that runs. Here a page has one mapping, and the permission to write to
// it is given back before the code runs (mprotect). What that costs: docs/explanation/emulator.md.
#pragma once

#include <cstddef>

#include <asmjit/core.h>

namespace kaz::h8s::translate {

class CodeMemory {
 public:
  // Size of the address range, bytes; pages are committed as code is added.
  static constexpr std::size_t kSize = std::size_t{16} << 20;

  CodeMemory() = default;
  ~CodeMemory();
  CodeMemory(const CodeMemory&) = delete;
  CodeMemory& operator=(const CodeMemory&) = delete;

  // Appends finished code. Null: the range is full, or the host refuses executable memory (a security
  // policy). Must not be called while code of this memory runs.
  const void* add(asmjit::CodeHolder& code);
  // Discards all code; its memory is reused.
  void clear() { used_ = 0; }

 private:
  std::byte* begin_ = nullptr;
  std::size_t used_ = 0;  // bytes
};

}  // namespace kaz::h8s::translate
