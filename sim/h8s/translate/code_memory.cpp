// One range of addresses, whose pages become writable, then executable.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/translate/code_memory.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstring>

namespace kaz::h8s::translate {
namespace {

constexpr std::size_t kAlignment = 64;  // a line of the host's cache

}  // namespace

CodeMemory::~CodeMemory() {
  if (begin_) ::munmap(begin_, kSize);
}

const void* CodeMemory::add(asmjit::CodeHolder& code) {
  if (!begin_) {
    void* const p =
        ::mmap(nullptr, kSize, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (p == MAP_FAILED) return nullptr;
    begin_ = static_cast<std::byte*>(p);
  }
  if (code.flatten() != asmjit::kErrorOk || code.resolveUnresolvedLinks() != asmjit::kErrorOk)
    return nullptr;
  const std::size_t size = code.codeSize();  // at most: relocation may shorten it
  if (size == 0 || size > kSize - used_) return nullptr;
  std::byte* const base = begin_ + used_;
  if (code.relocateToBase(reinterpret_cast<std::uintptr_t>(base)) != asmjit::kErrorOk)
    return nullptr;

  // The first page may hold the end of other code, which does not run meanwhile.
  static const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  std::byte* const first = begin_ + used_ / page * page;
  const auto length = static_cast<std::size_t>(base + size - first);
  if (::mprotect(first, length, PROT_READ | PROT_WRITE) != 0) return nullptr;
  for (const asmjit::Section* section : code.sections()) {
    std::byte* const to = base + section->offset();
    const std::size_t filled = section->bufferSize();
    if (filled != 0) std::memcpy(to, section->data(), filled);
    if (section->virtualSize() > filled)
      std::memset(to + filled, 0, section->virtualSize() - filled);
  }
  if (::mprotect(first, length, PROT_READ | PROT_EXEC) != 0) return nullptr;
  used_ = (used_ + size + kAlignment - 1) / kAlignment * kAlignment;
  return base;
}

}  // namespace kaz::h8s::translate
