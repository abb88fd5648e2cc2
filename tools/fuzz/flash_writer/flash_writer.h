// Sends hostile frames to the flash writer in an emulated board (docs/howto/fuzzing.md).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace kaz::fuzz {

// The bytes determine how the writer is started, and which data a hostile host sends. The data consist of
// valid requests of any type, address and length, raw bytes, and pauses. Requests may be damaged, truncated,
// repeated, or sent without pauses. Returns the first violation (writer_judge.h); nullopt: no violation.
std::optional<std::string> try_flash_writer(std::span<const std::uint8_t> bytes);

// Runs the case of try_flash_writer(). Returns a text with one line for each transmission and each answer,
// and the result of the case.
std::string flash_writer_text(std::span<const std::uint8_t> bytes);

}  // namespace kaz::fuzz
