// An emulated board in which the flash writer waits for requests, and the host's end of the serial line.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/h8s/chip/chip.h"

namespace kaz::fuzz {

// How the writer was started. `loader`: by the resident loader of a board without a valid application.
// `boot`: by boot mode of an erased chip; only the writer's first stage is loaded. `boot_complete`: by boot
// mode of an erased chip; both stages are loaded.
enum class WriterStart { loader, boot, boot_complete };
inline constexpr WriterStart kWriterStarts[] = {WriterStart::loader, WriterStart::boot,
                                                WriterStart::boot_complete};

inline constexpr std::uint32_t kWriterRam = 0xffe080;  // start address of the writer's program

// Returns the content of writer.bin: both stages, as stored in RAM. Aborts if the file is missing.
const std::vector<std::uint8_t>& writer_program();
std::uint32_t writer_second_stage();  // start address of the second stage
std::uint32_t writer_program_end();   // address after the last byte of the program

// Encodes a frame for the writer (shared/flash/protocol.h).
std::vector<std::uint8_t> writer_frame(std::uint8_t type, std::uint8_t number,
                                       std::span<const std::uint8_t> payload);
// Computes the CRC-16 of frames bit by bit, independently of the code under test.
std::uint16_t writer_crc(std::span<const std::uint8_t> bytes);
// Appends `value` to `to` as a big-endian number with a length of `bytes` bytes.
void put_number(std::vector<std::uint8_t>& to, std::uint32_t value, int bytes);

struct WriterAnswer {
  std::uint8_t type = 0, number = 0;  // type and number in the frame; type includes KZ_WRITER_REPLY
  std::vector<std::uint8_t> payload;
  h8s::States begin = 0, end = 0;  // begin and end of the transmission
  std::uint8_t status() const { return payload[0]; }
};

class WriterBoard {
 public:
  // Copies the state of a board whose writer waits for requests. This state is computed once for each value
  // of `start`. Not thread-safe. Aborts if the writer of this build does not start.
  explicit WriterBoard(WriterStart start);
  WriterBoard(const WriterBoard&) = delete;

  static constexpr h8s::States kMillisecond = 18432;

  // Sends bytes at the board's bit rate, after the bytes that are still in transit. Returns the arrival time
  // of the last byte.
  h8s::States send(std::span<const std::uint8_t> bytes);
  // Keeps the line silent for the time `states` after the last sent byte.
  void pause(h8s::States states);
  // Runs the board for the time `states`. Stops early if the emulator stops (failure()), or if `until`
  // returns true. `until` is called every 1/8 ms.
  void run(h8s::States states, const std::function<bool()>& until = {});
  // Returns the oldest frame from the board that was not returned yet. If bytes from the board are not a
  // valid frame, sets failure().
  std::optional<WriterAnswer> take_answer();
  // Sends one request after 25 ms of silence, and returns the answer. nullopt: no answer arrived within
  // `patience`.
  std::optional<WriterAnswer> request(std::uint8_t type, std::span<const std::uint8_t> payload,
                                      h8s::States patience = 1500 * kMillisecond);

  h8s::Chip& chip() { return chip_; }
  h8s::States now() const { return chip_.now(); }
  std::vector<std::uint8_t> memory(std::uint32_t address, std::size_t size) const;
  // Returns the reason why the emulator stopped, or how the board violated the frame format. Empty: no
  // failure.
  const std::string& failure() const { return failure_; }

 private:
  void parse();

  h8s::Chip chip_;
  std::vector<h8s::TransmittedByte> came_;
  std::vector<WriterAnswer> answers_;
  h8s::States line_free_ = 0;
  std::uint8_t number_ = 0x80;
  std::string failure_;
};

}  // namespace kaz::fuzz
