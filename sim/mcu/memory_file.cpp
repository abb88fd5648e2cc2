// A board's non-volatile memory, kept in a file between runs.
// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/memory_file.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>

#include "shared/base/files.hpp"

namespace kaz::sim {

Result<void> load_memory(Mcu& mcu, const std::string& path) {
  std::error_code unknown;
  if (!std::filesystem::exists(path, unknown)) return {};
  const auto bytes = KAZ_TRY(read_whole_file(path, 1 << 20, "give the memory file of a board"));
  std::array<std::uint8_t, Mcu::kMemorySize> memory{};
  if (bytes.size() != memory.size())
    return fail(Fault::usage, path + ": the memory of a board must have " +
                                  std::to_string(Mcu::kMemorySize) +
                                  " bytes; give another file, or remove it");
  std::ranges::copy(bytes, memory.begin());
  mcu.set_memory(memory);
  return {};
}

Result<void> save_memory(const Mcu& mcu, const std::string& path) {
  const auto memory = mcu.memory();
  return write_whole_file(path, {reinterpret_cast<const char*>(memory.data()), memory.size()});
}

}  // namespace kaz::sim
