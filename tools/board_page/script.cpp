// A session by a list of commands, and everything that it did as text.
// SPDX-License-Identifier: Apache-2.0
#include "tools/board_page/script.h"

#include <bit>
#include <cstdio>
#include <sstream>

#include "tools/board_page/view.h"

namespace kaz::board_page {
namespace {

// FNV-1a, 64 bits.
class Digest {
 public:
  void add(std::uint64_t number, int bytes) {
    for (int i = 0; i < bytes; ++i) {
      value_ ^= number >> 8 * i & 0xff;
      value_ *= 0x100000001b3u;
    }
  }
  void add(double number) { add(std::bit_cast<std::uint64_t>(number), 8); }
  unsigned long long value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325u;
};

// RAM, I/O page, and the flash's blocks for calibration.
unsigned long long memory_digest(const h8s::Chip& chip) {
  Digest digest;
  for (std::uint32_t at = 0xffe080; at <= 0xffffff; ++at) digest.add(chip.peek(at).value_or(0), 1);
  for (std::uint32_t at = 0x400; at < 0x1000; ++at) digest.add(chip.peek(at).value_or(0), 1);
  return digest.value();
}

unsigned long long pin_digest(const sim::ServoBoard& board) {
  Digest digest;
  const sim::PinLevels& pins = board.pins();
  for (const std::uint16_t counts : pins.pw) digest.add(counts, 2);
  for (const std::uint16_t counts : pins.tmo) digest.add(counts, 2);
  for (const std::uint8_t port : {pins.p3, pins.p4, pins.p5, pins.p6}) digest.add(port, 1);
  return digest.value();
}

// Bit patterns of what is not the chip's: motors, supply, drivers.
unsigned long long stand_digest(const Session& session) {
  Digest digest;
  for (const sim::JointState& joint : session.stand().joints()) {
    for (const double number :
         {joint.angle, joint.velocity, joint.torque, joint.current, joint.winding_celsius})
      digest.add(number);
  }
  digest.add(session.board().supply_volts());
  digest.add(session.board().driver_celsius());
  return digest.value();
}

void print_line(Session& session, std::string& text) {
  for (const LineEntry& entry : session.take_line()) {
    text += (entry.to_board ? "out " : "in ") + std::to_string(entry.at) + " " + hex(entry.wire) +
            " result " + std::to_string(entry.result) + "\n";
  }
}

void print_state(const Session& session, std::string& text) {
  const h8s::Chip& chip = session.mcu().chip();
  char line[300];
  std::snprintf(
      line, sizeof line,
      "at %lld chip %lld instructions %lld pc %06x memory %016llx pins %016llx stand %016llx "
      "joint0 %a\n",
      static_cast<long long>(session.now()), static_cast<long long>(chip.now()),
      static_cast<long long>(chip.instructions()), static_cast<unsigned>(chip.registers().pc),
      memory_digest(chip), pin_digest(session.board()), stand_digest(session),
      session.stand().joints()[0].angle);
  text += line;
}

bool read_hex(std::istream& from, std::vector<std::uint8_t>& bytes) {
  std::string digits;
  if (!(from >> digits)) return true;
  if (digits.size() % 2 != 0) return false;
  const auto nibble = [](char c) {
    return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
  };
  for (std::size_t i = 0; i < digits.size(); i += 2) {
    const int high = nibble(digits[i]), low = nibble(digits[i + 1]);
    if (high < 0 || low < 0) return false;
    bytes.push_back(static_cast<std::uint8_t>(16 * high + low));
  }
  return true;
}

// False: no such command, or not these arguments.
bool execute(Session& session, const std::string& command, std::istream& words) {
  std::vector<std::uint8_t> type, bytes;
  std::size_t joint = 0;
  double number = 0;
  int whole = 0;
  if (command == "send") {
    if (!read_hex(words, type) || type.size() != 1 || !read_hex(words, bytes)) return false;
    session.send(1, type[0], bytes);
  } else if (command == "raw") {
    if (!read_hex(words, bytes)) return false;
    session.send_raw(bytes);
  } else if (command == "keep") {
    if (!(words >> whole)) return false;
    session.keep_alive(whole);
  } else if (command == "turn" || command == "press") {
    if (!(words >> joint >> number) || joint >= KZ_JOINTS) return false;
    if (command == "turn") {
      session.turn(joint, number);
    } else {
      session.stand().press(joint, number);
    }
  } else if (command == "release") {
    if (!(words >> joint) || joint >= KZ_JOINTS) return false;
    session.release(joint);
  } else if (command == "supply") {
    if (!(words >> number)) return false;
    session.board().set_supply(number);
  } else if (command == "power") {
    if (!(words >> whole)) return false;
    session.board().set_power(whole != 0);
  } else if (command == "reset") {
    session.board().reset();
  } else {
    return false;
  }
  return true;
}

}  // namespace

Result<std::string> run_script(Session& session, const std::string& script) {
  std::istringstream lines(script);
  std::string line, text;
  for (int number = 1; std::getline(lines, line); ++number) {
    std::istringstream words(line);
    std::string command;
    if (!(words >> command) || command[0] == '#') continue;
    if (command == "run") {
      int milliseconds = 0;
      words >> milliseconds;
      for (int i = 0; i < milliseconds; ++i) KAZ_TRY(session.step());
      print_line(session, text);
      print_state(session, text);
    } else if (!execute(session, command, words)) {
      return fail(Fault::usage, "line " + std::to_string(number) + " of the script, \"" + line +
                                    "\": see tools/board_page/script.h for the commands");
    }
  }
  return text;
}

}  // namespace kaz::board_page
