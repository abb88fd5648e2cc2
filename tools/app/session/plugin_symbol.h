// Finds the name of the function at an address in a shared object.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace kaz::tools {

// Reads the symbol table of a 64-bit ELF file. So function_at() also finds functions that are not exported,
// unlike dladdr(). Returns the demangled name of the function. Returns "" if the file cannot be read, or if
// the file has no symbol at this address because the file is stripped. `offset` is the address of the
// function relative to the load address. The file is trusted, so use function_at() only for files whose code
// runs in this process.
std::string function_at(const std::string& path, std::uint64_t offset);

}  // namespace kaz::tools
