// An emulated board in which the flash writer waits for requests, and the host's end of its line.
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
// `boot`: by boot mode of an erased chip, first stage only. `boot_complete`: the same with the second stage.
enum class WriterStart { loader, boot, boot_complete };
inline constexpr WriterStart kWriterStarts[] = {WriterStart::loader, WriterStart::boot,
                                                WriterStart::boot_complete};

inline constexpr std::uint32_t kWriterRam = 0xffe080;  // start address of the writer's program

// Returns writer.bin: both stages as they lie in RAM. Aborts if the file is missing.
const std::vector<std::uint8_t>& writer_program();
std::uint32_t writer_second_stage();  // start address
std::uint32_t writer_program_end();   // address behind the program

// Encodes a frame to the writer (shared/flash/protocol.h).
std::vector<std::uint8_t> writer_frame(std::uint8_t type, std::uint8_t number,
                                       std::span<const std::uint8_t> payload);
// Computes the CRC-16 of frames bit by bit, independently of the code under test.
std::uint16_t writer_crc(std::span<const std::uint8_t> bytes);
// Appends a number of `bytes` bytes, big-endian.
void put_number(std::vector<std::uint8_t>& to, std::uint32_t value, int bytes);

struct WriterAnswer {
  std::uint8_t type = 0, number = 0;  // as in the frame; type includes KZ_WRITER_REPLY
  std::vector<std::uint8_t> payload;
  h8s::States begin = 0, end = 0;  // transmission
  std::uint8_t status() const { return payload[0]; }
};

class WriterBoard {
 public:
  // Starts from a snapshot that is made once for each kind of start. Not thread-safe. Aborts if the writer of
  // this build does not start.
  explicit WriterBoard(WriterStart start);
  WriterBoard(const WriterBoard&) = delete;

  static constexpr h8s::States kMillisecond = 18432;

  // Sends bytes at the board's bit rate, after those still in transit. Returns the arrival time of the last.
  h8s::States send(std::span<const std::uint8_t> bytes);
  // Keeps the line silent for this time after the last byte sent.
  void pause(h8s::States states);
  // Runs for this time. Stops early if the emulator stops (failure()) or `until` returns true, which is
  // checked every 1/8 ms.
  void run(h8s::States states, const std::function<bool()>& until = {});
  // Takes the oldest frame from the board that was not taken yet. Bytes that are not a valid frame set
  // failure().
  std::optional<WriterAnswer> take_answer();
  // Sends one request after 25 ms of silence and returns its answer. nullopt: timeout `patience`.
  std::optional<WriterAnswer> request(std::uint8_t type, std::span<const std::uint8_t> payload,
                                      h8s::States patience = 1500 * kMillisecond);

  h8s::Chip& chip() { return chip_; }
  h8s::States now() const { return chip_.now(); }
  std::vector<std::uint8_t> memory(std::uint32_t address, std::size_t size) const;
  // Why the emulator stopped, or how the board violated the frame format. Empty: no failure.
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
