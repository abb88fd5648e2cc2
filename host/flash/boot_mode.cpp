// The host's side of boot mode: rate, length, program with echo, erase check.
// SPDX-License-Identifier: Apache-2.0
#include "host/flash/boot_mode.h"

#include <algorithm>
#include <array>
#include <deque>
#include <string>
#include <vector>

#include "host/flash/diagnostic.h"

namespace kaz::host {
namespace {

using std::chrono::milliseconds;

// The chip echoes each byte, and has room for two. Up to kUnderWay bytes are sent ahead of their echoes,
// which hides the adapter's latency; every kBreath bytes all echoes are awaited, because a chip whose baud
// clock is slower than the host's falls behind.
constexpr std::size_t kUnderWay = 32, kBreath = 256;
// Blank check of 64 KB, and ten blocks erased and verified: less than a second of a healthy part.
constexpr Time kEraseTime = std::chrono::seconds(10);

class Boot {
 public:
  Boot(Link& link, Clock& clock, const BootOptions& options)
      : link_(link), clock_(clock), options_(options) {}

  Result<void> load(std::span<const std::uint8_t> program);

 private:
  Result<void> put(std::uint8_t byte) { return link_.write(std::span(&byte, 1)); }
  // The next byte, or -1.
  Result<int> get(Time patience);
  Result<void> greet();
  Result<void> echoed(std::uint8_t byte, const std::string& what);
  Result<void> send_program(std::span<const std::uint8_t> program);
  Result<void> finish();
  std::string rate() const { return std::to_string(options_.baud) + " baud"; }
  tl::unexpected<Error> failure(const std::string& step, const std::string& expected, int came,
                                std::vector<std::string> causes) const;

  Link& link_;
  Clock& clock_;
  const BootOptions& options_;
  std::deque<std::uint8_t> came_;
};

tl::unexpected<Error> Boot::failure(const std::string& step, const std::string& expected, int came,
                                    std::vector<std::string> causes) const {
  std::vector<std::uint8_t> bytes;
  if (came >= 0) bytes.push_back(static_cast<std::uint8_t>(came));
  for (const std::uint8_t byte : came_) bytes.push_back(byte);
  return fail(Fault::environment,
              Diagnostic{"boot mode failed at " + step, expected, hex_of(bytes), std::move(causes),
                         "give the same command again; boot mode can always be entered again"});
}

Result<int> Boot::get(Time patience) {
  if (came_.empty()) {
    std::array<std::uint8_t, 256> bytes{};
    const auto count = KAZ_TRY(link_.read(bytes, clock_.now() + patience));
    for (std::size_t k = 0; k < count; ++k) came_.push_back(bytes[k]);
  }
  if (came_.empty()) return -1;
  const int byte = came_.front();
  came_.pop_front();
  return byte;
}

// Sends H'00 until the chip replies with H'00: it measures start bit and eight zeros to set its baud rate.
Result<void> Boot::greet() {
  int answer = -1;
  for (int k = 0; k < options_.tries && answer != 0; ++k) {
    if (auto sent = put(0x00); !sent) return sent;
    const auto byte = KAZ_TRY(get(milliseconds(30)));
    if (byte > 0) came_.clear();  // of a program that still ran, or noise
    answer = byte;
  }
  if (answer != 0) {
    return failure("the first step (bit rate)",
                   "the byte H'00 as the reply to the byte H'00 at " + rate(), answer,
                   {"the board is not in boot mode: set the mode switch, then reset the board",
                    "wrong port, or TxD and RxD are swapped", "the board has no power",
                    "the board's crystal does not support " + rate() + "; try --boot-baud 4800"});
  }
  if (auto sent = put(0x55); !sent) return sent;
  // Parts without A mask may not answer.
  const auto byte = KAZ_TRY(get(milliseconds(100)));
  if (byte >= 0 && byte != 0xaa && byte != 0x00) {
    return failure("H'55", "H'AA or nothing", byte,
                   {"the line is noisy", "the bit rates do not match; try --boot-baud 4800"});
  }
  return {};
}

Result<void> Boot::echoed(std::uint8_t byte, const std::string& what) {
  const auto echo = KAZ_TRY(get(milliseconds(500)));
  if (echo == byte) return {};
  char text[48];
  std::snprintf(text, sizeof text, "the echo %02x", byte);
  return failure(what, text, echo,
                 {"the line lost or damaged a byte", "the board lost power or was reset",
                  "the program is too long for this chip"});
}

Result<void> Boot::send_program(std::span<const std::uint8_t> program) {
  std::size_t sent = 0, back = 0;
  while (back < program.size()) {
    const std::size_t breath = (back / kBreath + 1) * kBreath;
    const std::size_t end = std::min({program.size(), back + kUnderWay, breath});
    // In pieces of half the window: fewer, larger writes.
    if (end > sent && (end - sent >= kUnderWay / 2 || end == program.size() || end == breath)) {
      if (auto written = link_.write(program.subspan(sent, end - sent)); !written) return written;
      sent = end;
    }
    if (auto same = echoed(program[back], "byte " + std::to_string(back) + " of the program");
        !same)
      return same;
    ++back;
  }
  return {};
}

Result<void> Boot::finish() {
  const auto byte = KAZ_TRY(get(kEraseTime));
  if (byte == 0xaa) return {};
  if (byte == 0xff) {
    return fail(Fault::failed,
                Diagnostic{"the chip cannot erase its flash",
                           "H'AA",
                           "ff (erase error)",
                           {"the flash is worn out: the chip is rated for 100 erasures",
                            "the supply voltage is too low during erasing"},
                           "measure the supply voltage and try again; otherwise replace the chip"});
  }
  return failure("the erase check", "H'AA", byte,
                 {"the board lost power or was reset", "the line damaged a byte"});
}

Result<void> Boot::load(std::span<const std::uint8_t> program) {
  if (auto greeted = greet(); !greeted) return greeted;
  const auto count = static_cast<std::uint16_t>(program.size());
  for (const int shift : {8, 0}) {
    const auto byte = static_cast<std::uint8_t>(count >> shift);
    if (auto sent = put(byte); !sent) return sent;
    if (auto same = echoed(byte, "the program's length"); !same) return same;
  }
  if (auto sent = send_program(program); !sent) return sent;
  return finish();
}

}  // namespace

Result<void> load_through_boot(Link& link, Clock& clock, std::span<const std::uint8_t> program,
                               const BootOptions& options) {
  if (auto set = link.set_baud(options.baud); !set) return set;
  // Discards what the program that ran until the reset may still have sent.
  std::array<std::uint8_t, 256> old{};
  for (int k = 0; k < 20; ++k) {
    const auto count = KAZ_TRY(link.read(old, clock.now() + milliseconds(5)));
    if (count == 0) break;
  }
  return Boot(link, clock, options).load(program);
}

}  // namespace kaz::host
