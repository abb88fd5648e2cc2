// An emulated board in which the flash writer waits for its host, and the host's end of the line.
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

// How the writer came to run: started by the resident loader of a board without a valid application;
// by boot mode of an erased chip, its first stage alone; or with the second stage behind it.
enum class WriterStart { loader, boot, boot_complete };
inline constexpr WriterStart kWriterStarts[] = {WriterStart::loader, WriterStart::boot,
                                                WriterStart::boot_complete};

inline constexpr std::uint32_t kWriterRam = 0xffe080;  // where the writer's program begins

// writer.bin: both stages, as they lie in RAM.
const std::vector<std::uint8_t>& writer_program();
std::uint32_t writer_second_stage();  // address
std::uint32_t writer_program_end();

// A whole frame to the writer (shared/flash/protocol.h).
std::vector<std::uint8_t> writer_frame(std::uint8_t type, std::uint8_t number,
                                       std::span<const std::uint8_t> payload);
// CRC-16 of the frames, bit by bit.
std::uint16_t writer_crc(std::span<const std::uint8_t> bytes);
// Big-endian, appended.
void put_number(std::vector<std::uint8_t>& to, std::uint32_t value, int bytes);

struct WriterAnswer {
  std::uint8_t type = 0, number = 0;  // as they are in the frame, type with REPLY
  std::vector<std::uint8_t> payload;
  h8s::States begin = 0, end = 0;
  std::uint8_t status() const { return payload[0]; }
};

class WriterBoard {
 public:
  // Starts from a snapshot that is made once for each kind. Aborts where the build's own writer does
  // not start.
  explicit WriterBoard(WriterStart start);
  WriterBoard(const WriterBoard&) = delete;

  static constexpr h8s::States kMillisecond = 18432;

  // Bytes on the line, at the board's bit rate, behind those still in transit. Returns the time at
  // which the last of them has arrived.
  h8s::States send(std::span<const std::uint8_t> bytes);
  // Keeps the line silent from the last byte sent on.
  void pause(h8s::States states);
  // Runs on; stops early if the emulator stops (failure()) or `until` returns true, which is checked
  // each 1/8 ms.
  void run(h8s::States states, const std::function<bool()>& until = {});
  // Frames that the board has sent and that were not taken yet, in order. Anything that is no whole frame is
  // a failure().
  std::optional<WriterAnswer> take_answer();
  // A request by itself, with silence before it, and its answer.
  std::optional<WriterAnswer> request(std::uint8_t type, std::span<const std::uint8_t> payload,
                                      h8s::States patience = 1500 * kMillisecond);

  h8s::Chip& chip() { return chip_; }
  h8s::States now() const { return chip_.now(); }
  std::vector<std::uint8_t> memory(std::uint32_t address, std::size_t size) const;
  // Why the board cannot go on, or what it sent that is no frame; empty: nothing.
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
