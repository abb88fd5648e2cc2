// Boot mode and loader up to the writer's first frame; frames out of bytes.
// SPDX-License-Identifier: Apache-2.0
#include "tools/fuzz/flash_writer/writer_board.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <memory>

#include "shared/flash/image.h"
#include "shared/flash/protocol.h"
#include "shared/image/image.h"

namespace kaz::fuzz {
namespace {

using h8s::States;

constexpr States kClock = 18'432'000;
constexpr std::uint32_t kBitRateRegister = 0xffffd9;
constexpr std::uint8_t kBrr115200 = 4;

[[noreturn]] void give_up(const std::string& why) {
  std::fprintf(stderr, "flash writer: %s\n", why.c_str());
  std::abort();
}

// An erased chip whose boot ROM has just started the first stage, at 9,600 baud.
h8s::Chip booted() {
  h8s::Options options;
  options.mode = 0;
  h8s::Chip chip(options);
  for (int pin = 0; pin < 3; ++pin) chip.set_input(h8s::Port::p4, pin, true);
  std::vector<std::uint8_t> came;
  chip.on_transmit([&](int, const h8s::TransmittedByte& byte) { came.push_back(byte.value); });
  chip.power_on();
  constexpr States bit = kClock / 9600;
  const auto exchange = [&](std::uint8_t value) {
    came.clear();
    h8s::ReceivedByte byte;
    byte.value = value;
    byte.at = chip.now() + 10 * bit;
    byte.bit_states = bit;
    if (!chip.receive(0, byte)) give_up("the chip does not accept a byte in boot mode");
    chip.run_until(byte.at + 25 * bit);
    return came.empty() ? -1 : int{came.front()};
  };
  int answer = -1;
  for (int k = 0; k < 20 && answer != 0; ++k) answer = exchange(0);
  exchange(0x55);
  const std::uint32_t size = writer_second_stage() - kWriterRam;
  std::vector<std::uint8_t> bytes;
  put_number(bytes, size, 2);
  bytes.insert(bytes.end(), writer_program().begin(), writer_program().begin() + size);
  for (const std::uint8_t byte : bytes) {
    if (exchange(byte) != byte) give_up("the chip does not echo the program in boot mode");
  }
  chip.run_until(chip.now() + kClock / 2);
  if (chip.in_boot_rom()) give_up("the chip does not start the program after boot mode");
  chip.on_transmit({});
  return chip;
}

h8s::Chip loaded() {
  const auto image = h8s::load_image(KAZ_FIRMWARE_IMAGE);
  if (!image) give_up(image.error().message);
  h8s::Chip chip;
  if (const auto put = chip.load(*image); !put) give_up(put.error().message);
  chip.poke(KZ_APPLICATION_HEADER, 0);
  chip.power_on();
  chip.run_until(20 * WriterBoard::kMillisecond);
  return chip;
}

// What a flash is like that hostile frames are sent to: some lines are programmed.
void fill_lines(WriterBoard& board) {
  std::array<std::uint8_t, 32> line{};
  for (std::size_t k = 0; k < line.size(); ++k) line[k] = static_cast<std::uint8_t>(3 * k + 1);
  for (const std::uint32_t at : {0x420u, 0xe000u, 0x1ffe0u}) board.chip().poke(at, line);
}

}  // namespace

std::uint16_t writer_crc(std::span<const std::uint8_t> bytes) {
  unsigned crc = 0xffff;
  for (const std::uint8_t byte : bytes) {
    for (int bit = 7; bit >= 0; --bit) {
      const unsigned out = (crc >> 15 ^ byte >> bit) & 1u;
      crc = (crc << 1 & 0xffff) ^ (out ? 0x1021u : 0u);
    }
  }
  return static_cast<std::uint16_t>(crc);
}

void put_number(std::vector<std::uint8_t>& to, std::uint32_t value, int bytes) {
  for (int k = bytes - 1; k >= 0; --k) to.push_back(static_cast<std::uint8_t>(value >> (8 * k)));
}

const std::vector<std::uint8_t>& writer_program() {
  static const std::vector<std::uint8_t> bytes = [] {
    std::ifstream file(KAZ_WRITER, std::ios::binary);
    std::vector<std::uint8_t> read{std::istreambuf_iterator<char>(file), {}};
    if (read.size() < 64) give_up("no flash writer in " KAZ_WRITER);
    return read;
  }();
  return bytes;
}

std::uint32_t writer_second_stage() {
  return kWriterRam + (std::uint32_t{writer_program()[2]} << 8 | writer_program()[3]);
}

std::uint32_t writer_program_end() {
  return kWriterRam + static_cast<std::uint32_t>(writer_program().size());
}

std::vector<std::uint8_t> writer_frame(std::uint8_t type, std::uint8_t number,
                                       std::span<const std::uint8_t> payload) {
  std::vector<std::uint8_t> frame{KZ_WRITER_SYNC, type};
  put_number(frame, static_cast<std::uint32_t>(payload.size()), 2);
  frame.push_back(number);
  unsigned sum = 0;
  for (std::size_t k = 1; k < frame.size(); ++k) sum += frame[k];
  frame.push_back(static_cast<std::uint8_t>(~sum));
  frame.insert(frame.end(), payload.begin(), payload.end());
  put_number(frame, writer_crc(std::span(frame).subspan(1)), 2);
  return frame;
}

WriterBoard::WriterBoard(WriterStart start) {
  static std::shared_ptr<const h8s::Chip> snapshots[std::size(kWriterStarts)];
  auto& snapshot = snapshots[static_cast<std::size_t>(start)];
  if (!snapshot) {
    chip_ = start == WriterStart::loader ? loaded() : booted();
    chip_.on_transmit([this](int, const h8s::TransmittedByte& byte) { came_.push_back(byte); });
    if (start != WriterStart::loader) {
      const auto set = request(KZ_WRITER_RATE, std::array{kBrr115200});
      if (!set || set->status() != KZ_WRITER_OK) give_up("the writer does not accept the bit rate");
      run(kMillisecond);
    }
    for (std::uint32_t at = writer_second_stage();
         start == WriterStart::boot_complete && at < writer_program_end();) {
      const std::uint32_t size = std::min(writer_program_end() - at, 512u);
      std::vector<std::uint8_t> payload;
      put_number(payload, at, 4);
      const auto from = writer_program().begin() + (at - kWriterRam);
      payload.insert(payload.end(), from, from + size);
      const auto put = request(KZ_WRITER_WRITE, payload);
      if (!put || put->status() != KZ_WRITER_OK)
        give_up("the writer does not accept its second stage");
      at += size;
    }
    fill_lines(*this);
    run(30 * kMillisecond);
    snapshot = chip_.save();
    came_.clear();
    answers_.clear();
    number_ = 0x80;
  }
  chip_ = snapshot->clone();
  chip_.on_transmit([this](int, const h8s::TransmittedByte& byte) { came_.push_back(byte); });
  line_free_ = now();
}

States WriterBoard::send(std::span<const std::uint8_t> bytes) {
  const States bit = 32 * (States{chip_.peek(kBitRateRegister).value_or(kBrr115200)} + 1);
  line_free_ = std::max(line_free_, now());
  for (const std::uint8_t value : bytes) {
    line_free_ += 10 * bit;
    h8s::ReceivedByte byte;
    byte.value = value;
    byte.at = line_free_;
    byte.bit_states = bit;
    if (auto put = chip_.receive(0, byte); !put) failure_ = put.error().message;
  }
  return line_free_;
}

void WriterBoard::pause(States states) {
  line_free_ = std::max(line_free_, now()) + states;
}

void WriterBoard::run(States states, const std::function<bool()>& until) {
  const States end = now() + states;
  while (now() < end && failure_.empty()) {
    const h8s::Stop stop = chip_.run_until(std::min(end, now() + kMillisecond / 8));
    if (stop.reason != h8s::Stop::Reason::reached)
      failure_ = "the emulated chip stopped: " + stop.report;
    if (until && until()) break;
  }
}

std::optional<WriterAnswer> WriterBoard::take_answer() {
  parse();
  if (answers_.empty()) return std::nullopt;
  WriterAnswer first = std::move(answers_.front());
  answers_.erase(answers_.begin());
  return first;
}

void WriterBoard::parse() {
  while (came_.size() >= KZ_WRITER_HEADER && failure_.empty()) {
    std::vector<std::uint8_t> bytes;
    for (const auto& byte : came_) bytes.push_back(byte.value);
    const std::size_t length = std::size_t{bytes[2]} << 8 | bytes[3];
    unsigned sum = 0;
    for (std::size_t k = 1; k < KZ_WRITER_HEADER; ++k) sum += bytes[k];
    const std::size_t whole = length + KZ_WRITER_OVERHEAD;
    if (bytes[0] != KZ_WRITER_SYNC || (sum & 0xff) != 0xff || length < 2 ||
        length > KZ_WRITER_PAYLOAD_MAX || !(bytes[1] & KZ_WRITER_REPLY)) {
      failure_ = "the board sent an invalid reply header";
      return;
    }
    if (bytes.size() < whole) return;
    if (writer_crc(std::span(bytes).subspan(1, whole - 1)) != 0) {
      failure_ = "the board sent a frame with a wrong CRC";
      return;
    }
    answers_.push_back(
        {bytes[1],
         bytes[4],
         {bytes.begin() + KZ_WRITER_HEADER, bytes.begin() + static_cast<std::ptrdiff_t>(whole) - 2},
         came_.front().start,
         came_[whole - 1].end});
    came_.erase(came_.begin(), came_.begin() + static_cast<std::ptrdiff_t>(whole));
  }
}

std::optional<WriterAnswer> WriterBoard::request(std::uint8_t type,
                                                 std::span<const std::uint8_t> payload,
                                                 States patience) {
  const std::uint8_t number = ++number_;
  pause(25 * kMillisecond);
  const States sent = send(writer_frame(type, number, payload));
  std::optional<WriterAnswer> found;
  run(sent - now() + patience, [&] {
    while (auto answer = take_answer()) {
      if (answer->type == (type | KZ_WRITER_REPLY) && answer->number == number) found = answer;
    }
    return found.has_value();
  });
  return found;
}

std::vector<std::uint8_t> WriterBoard::memory(std::uint32_t address, std::size_t size) const {
  std::vector<std::uint8_t> bytes(size);
  chip_.peek(address, bytes);
  return bytes;
}

}  // namespace kaz::fuzz
