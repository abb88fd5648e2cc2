// The name of the function that an address in a shared object belongs to.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace kaz::tools {

// From the symbol table of the ELF file (64 bit, of this machine), demangled; also functions that are not
// exported, which dladdr() does not know. `offset`: from where the file is loaded. Empty if the file has no
// such symbol (stripped), or cannot be read. The file is one whose code runs in this process.
std::string function_at(const std::string& path, std::uint64_t offset);

}  // namespace kaz::tools
