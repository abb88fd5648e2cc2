// A board's non-volatile memory, kept in a file between runs.
// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/memory_file.h"

#include <filesystem>
#include <fstream>
#include <system_error>

#include "shared/base/files.hpp"

namespace kaz::sim {

Result<void> load_memory(Mcu& mcu, const std::string& path) {
  std::error_code unknown;
  if (!std::filesystem::exists(path, unknown)) return {};
  std::array<char, Mcu::memory_size> bytes{};
  std::ifstream file(path, std::ios::binary);
  file.read(bytes.data(), bytes.size());
  if (!file || file.peek() != std::ifstream::traits_type::eof())
    return fail(Fault::usage, path + " is no memory of a board, which has " +
                                  std::to_string(Mcu::memory_size) +
                                  " bytes; name another file, or remove it");
  std::array<std::uint8_t, Mcu::memory_size> memory{};
  for (std::size_t i = 0; i < memory.size(); ++i) memory[i] = static_cast<std::uint8_t>(bytes[i]);
  mcu.set_memory(memory);
  return {};
}

Result<void> save_memory(const Mcu& mcu, const std::string& path) {
  const auto memory = mcu.memory();
  return write_whole_file(path, {reinterpret_cast<const char*>(memory.data()), memory.size()});
}

}  // namespace kaz::sim
