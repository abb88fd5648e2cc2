// Finds the name of the function at an address in a shared object.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace kaz::tools {

// Reads the symbol table of a 64-bit ELF file, so it also finds functions that are not exported, unlike
// dladdr(). Returns the demangled name. Returns "" if the file has no such symbol (stripped) or cannot be
// read. `offset` is relative to the load address. Use it only for files whose code runs in this process: the
// file is trusted.
std::string function_at(const std::string& path, std::uint64_t offset);

}  // namespace kaz::tools
