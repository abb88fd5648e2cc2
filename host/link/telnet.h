// Telnet (RFC 854) with COM-PORT-OPTION (RFC 2217): bytes of a serial port with commands between them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace kaz::host::telnet {

// Commands of RFC 854.
inline constexpr std::uint8_t kSe = 240, kSb = 250, kWill = 251, kWont = 252, kDo = 253,
                              kDont = 254, kIac = 255;
// Options of RFC 856, 857, 858 and 2217.
inline constexpr std::uint8_t kBinary = 0, kEcho = 1, kSuppressGoAhead = 3, kComPort = 44;

// Commands of a client, RFC 2217 section 3. The code of a server's reply is the command's code plus 100.
enum ComPort : std::uint8_t {
  kSignature = 0,
  kBaudRate = 1,  // 4 bytes, big-endian; 0 queries the rate
  kDataSize = 2,  // number of data bits, 5..8
  kParity = 3,    // 1: no parity
  kStopSize = 4,  // 1: one stop bit
  kControl = 5,   // one of the values below, such as kDtrOn
  kNotifyLineState = 6,
  kNotifyModemState = 7,
  kSuspend = 8,
  kResume = 9,
  kLineStateMask = 10,
  kModemStateMask = 11,
  kPurge = 12,  // the bits below, such as kPurgeUnsent
  kReply = 100,
};
// Values of kControl.
inline constexpr std::uint8_t kNoFlowControl = 1, kQueryDtr = 7, kDtrOn = 8, kDtrOff = 9,
                              kQueryRts = 10, kRtsOn = 11, kRtsOff = 12;

// Bits of kPurge. The bit kPurgeReceived selects the bytes that the server has received from its port. The
// bit kPurgeUnsent selects the bytes that the server has not sent to its port yet.
inline constexpr std::uint8_t kPurgeReceived = 1, kPurgeUnsent = 2;

struct Command {
  std::uint8_t verb = 0;           // kWill, kWont, kDo, kDont, or kSb for COM-PORT-OPTION
  std::uint8_t what = 0;           // number of the option; if `verb` is kSb, a ComPort command
  std::vector<std::uint8_t> data;  // data of the command if `verb` is kSb; else empty
  bool operator==(const Command&) const = default;
};

// Parser of a telnet stream that accepts pieces of any size and keeps the order of data and commands. The
// parser stores only two things: the data bytes that take_data() has not returned yet, and at most one
// command.
class Reader {
 public:
  // Maximum number of data bytes in one command. A command with more data bytes is dropped and counted.
  static constexpr std::size_t kMaxData = 64;

  // Parses `wire` up to the end of the next command, and returns that command; nullopt if `wire` ends before
  // the end of a command. Removes the parsed bytes from `wire`.
  std::optional<Command> take(std::span<const std::uint8_t>& wire);
  // Returns the data bytes parsed since the last call of take_data(). If the last call of take() returned a
  // command, the returned data bytes precede that command in the stream.
  std::vector<std::uint8_t> take_data();
  // Number of sub-negotiations that were dropped because they were too short, too long, broken off, or not
  // for COM-PORT-OPTION.
  std::uint64_t dropped() const { return dropped_; }

 private:
  enum class State { data, iac, option, sub, sub_iac };
  std::optional<Command> take_byte(std::uint8_t byte);
  std::optional<Command> end_sub();

  State state_ = State::data;
  std::uint8_t verb_ = 0;
  std::vector<std::uint8_t> sub_;  // bytes of a sub-negotiation: option, command, data
  bool too_long_ = false;
  std::vector<std::uint8_t> data_;
  std::uint64_t dropped_ = 0;
};

// The three functions below append the wire format of data, an option command or a COM-PORT command to
// `wire`.
void put_data(std::span<const std::uint8_t> bytes, std::vector<std::uint8_t>& wire);
void put_option(std::uint8_t verb, std::uint8_t option, std::vector<std::uint8_t>& wire);
void put_com_port(std::uint8_t command, std::span<const std::uint8_t> data,
                  std::vector<std::uint8_t>& wire);
std::vector<std::uint8_t> big_endian(std::uint32_t value);
// Returns 0 if `data` has fewer than 4 bytes.
std::uint32_t read_big_endian(std::span<const std::uint8_t> data);

enum class End { client, server };

// Negotiates the options of one end of a connection. Agrees once to each supported option, and declines every
// other option once. This rule prevents an endless exchange of replies between the two ends.
class Options {
 public:
  // Writes this end's initial offers and requests. A server does not offer option 44 first. If a server
  // offered option 44 first, the client pyserial would mistake this offer for a reply, and would never send
  // its own offer.
  void begin(End end, std::vector<std::uint8_t>& wire);
  // Processes an option command from the other end, and appends the reply to `wire` if a reply is due.
  void take(const Command& command, std::vector<std::uint8_t>& wire);
  // com_port() returns whether both ends support RFC 2217. refused() returns whether the other end has
  // declined RFC 2217.
  bool com_port() const { return com_port_; }
  bool refused() const { return refused_; }

 private:
  std::vector<bool> answered_ = std::vector<bool>(4 * 256);
  bool com_port_ = false, refused_ = false;
};

}  // namespace kaz::host::telnet
