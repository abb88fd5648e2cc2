// Reader and writer of telnet with COM-PORT-OPTION.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/telnet.h"

#include <algorithm>
#include <utility>

namespace kaz::host::telnet {

namespace {

constexpr std::uint8_t kWanted[] = {kBinary, kSuppressGoAhead, kComPort};

bool wanted(std::uint8_t option) {
  return std::ranges::find(kWanted, option) != std::end(kWanted);
}

}  // namespace

std::optional<Command> Reader::take(std::span<const std::uint8_t>& wire) {
  while (!wire.empty()) {
    const std::uint8_t byte = wire.front();
    wire = wire.subspan(1);
    if (auto command = take_byte(byte)) return command;
  }
  return std::nullopt;
}

std::optional<Command> Reader::take_byte(std::uint8_t byte) {
  switch (state_) {
    case State::data:
      if (byte == kIac) {
        state_ = State::iac;
      } else {
        data_.push_back(byte);
      }
      break;
    case State::iac:
      state_ = State::data;
      if (byte == kIac) {
        data_.push_back(kIac);
      } else if (byte >= kWill && byte <= kDont) {
        verb_ = byte;
        state_ = State::option;
      } else if (byte == kSb) {
        sub_.clear();
        too_long_ = false;
        state_ = State::sub;
      }  // else a command without an option, such as NOP
      break;
    case State::option:
      state_ = State::data;
      return Command{verb_, byte, {}};
    case State::sub:
      if (byte == kIac) {
        state_ = State::sub_iac;
      } else if (sub_.size() < kMaxData + 2) {
        sub_.push_back(byte);
      } else {
        too_long_ = true;
      }
      break;
    case State::sub_iac:
      if (byte == kIac) {
        state_ = State::sub;
        if (sub_.size() < kMaxData + 2) {
          sub_.push_back(kIac);
        } else {
          too_long_ = true;
        }
      } else if (byte == kSe) {
        state_ = State::data;
        return end_sub();
      } else {
        // Broken off; what comes is another command.
        ++dropped_;
        state_ = State::iac;
        return take_byte(byte);
      }
      break;
  }
  return std::nullopt;
}

std::optional<Command> Reader::end_sub() {
  if (too_long_ || sub_.size() < 2 || sub_[0] != kComPort) {
    ++dropped_;
    return std::nullopt;
  }
  return Command{kSb, sub_[1], {sub_.begin() + 2, sub_.end()}};
}

std::vector<std::uint8_t> Reader::take_data() {
  return std::exchange(data_, {});
}

void put_data(std::span<const std::uint8_t> bytes, std::vector<std::uint8_t>& wire) {
  for (const std::uint8_t byte : bytes) {
    wire.push_back(byte);
    if (byte == kIac) wire.push_back(kIac);
  }
}

void put_option(std::uint8_t verb, std::uint8_t option, std::vector<std::uint8_t>& wire) {
  wire.insert(wire.end(), {kIac, verb, option});
}

void put_com_port(std::uint8_t command, std::span<const std::uint8_t> data,
                  std::vector<std::uint8_t>& wire) {
  wire.insert(wire.end(), {kIac, kSb, kComPort, command});
  put_data(data, wire);
  wire.insert(wire.end(), {kIac, kSe});
}

std::vector<std::uint8_t> big_endian(std::uint32_t value) {
  return {static_cast<std::uint8_t>(value >> 24), static_cast<std::uint8_t>(value >> 16),
          static_cast<std::uint8_t>(value >> 8), static_cast<std::uint8_t>(value)};
}

std::uint32_t read_big_endian(std::span<const std::uint8_t> data) {
  if (data.size() < 4) return 0;
  return std::uint32_t{data[0]} << 24 | std::uint32_t{data[1]} << 16 | std::uint32_t{data[2]} << 8 |
         data[3];
}

void Options::begin(End end, std::vector<std::uint8_t>& wire) {
  for (const std::uint8_t option : kWanted) {
    if (option == kComPort && end == End::server) continue;
    for (const std::uint8_t verb : {kWill, kDo}) {
      put_option(verb, option, wire);
      // The other end's DO answers our WILL, and needs no answer.
      const std::uint8_t answer = verb == kWill ? kDo : kWill;
      answered_[std::size_t{256} * (answer - kWill) + option] = true;
    }
  }
}

void Options::take(const Command& command, std::vector<std::uint8_t>& wire) {
  if (command.verb < kWill || command.verb > kDont) return;
  const bool agrees = command.verb == kWill || command.verb == kDo;
  if (command.what == kComPort) {
    com_port_ = com_port_ || agrees;
    refused_ = refused_ || !agrees;
  }
  auto answered = answered_[std::size_t{256} * (command.verb - kWill) + command.what];
  if (answered) return;
  answered = true;
  const bool yes = agrees && wanted(command.what);
  const bool theirs = command.verb == kWill || command.verb == kWont;
  put_option(theirs ? (yes ? kDo : kDont) : (yes ? kWill : kWont), command.what, wire);
}

}  // namespace kaz::host::telnet
