// What a board remembers without power, kept in a file between two runs.
// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/memory_file.h"

#include <filesystem>
#include <fstream>
#include <system_error>

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
  const std::string beside = path + ".new";
  const auto memory = mcu.memory();
  std::array<char, Mcu::memory_size> bytes{};
  for (std::size_t i = 0; i < memory.size(); ++i) bytes[i] = static_cast<char>(memory[i]);
  std::ofstream file(beside, std::ios::binary);
  file.write(bytes.data(), bytes.size());
  file.close();
  std::error_code error;
  if (file) std::filesystem::rename(beside, path, error);
  if (!file || error)
    return fail(Fault::environment,
                "the board's memory cannot be written to " + path + "; is its folder writable?");
  return {};
}

}  // namespace kaz::sim
