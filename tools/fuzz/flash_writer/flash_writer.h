// Hostile frames to the flash writer in an emulated board (docs/howto/fuzzing.md).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace kaz::fuzz {

// The bytes choose how the writer was started and what a hostile host sends: valid requests with any
// type, address and length, damaged ones, cut short, repeated, back to back, raw bytes, pauses. Returns
// what is wrong, if anything (writer_judge.h).
std::optional<std::string> try_flash_writer(std::span<const std::uint8_t> bytes);

// The same case as text, one line each of what is sent and answered.
std::string flash_writer_text(std::span<const std::uint8_t> bytes);

}  // namespace kaz::fuzz
