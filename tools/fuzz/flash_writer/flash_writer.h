// Sends hostile frames to the flash writer in an emulated board (docs/howto/fuzzing.md).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace kaz::fuzz {

// The bytes choose how the writer was started and what a hostile host sends: valid requests of any type,
// address and length, raw bytes, and pauses. Requests may be damaged, cut short, repeated or back to back.
// Returns the first violation (writer_judge.h); nullopt: none.
std::optional<std::string> try_flash_writer(std::span<const std::uint8_t> bytes);

// Runs the same case. Returns it as text, one line for each transmission and answer, and its result.
std::string flash_writer_text(std::span<const std::uint8_t> bytes);

}  // namespace kaz::fuzz
