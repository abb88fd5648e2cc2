// What comes over a bus or a network: CAN messages and error frames, telnet with RFC 2217, files of boards.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>
#include <vector>

#include "hil/fuzz/choices.h"
#include "host/link/can_link.h"
#include "host/link/can_sockets_testing.h"
#include "host/link/telnet.h"
#include "host/link/wall_clock.h"
#include "host/robot/robot.h"
#include "shared/protocol/frame.h"
#include "tools/fuzz/inputs/input.h"
#include "tools/fuzz/inputs/targets.h"
#include "tools/run/board_file.h"

namespace kaz::fuzz {
namespace {

using hil::fuzz::Choices;
using Wire = std::vector<std::uint8_t>;

Wire bytes_of(Choices& choices, unsigned length) {
  Wire bytes;
  for (unsigned k = 0; k < length; ++k) bytes.push_back(choices.byte());
  return bytes;
}

Wire frame_to(std::uint8_t address) {
  const std::uint8_t body[] = {address, KZ_TYPE_state, 7};
  Wire wire(KZ_FRAME_MAX);
  wire.resize(kz_frame_encode(body, sizeof body, wire.data()));
  return wire;
}

// All that is there, and whether the link failed.
bool read_all(host::CanLink& link, Wire& all) {
  std::uint8_t some[64];
  while (true) {
    const auto count = link.read(some, host::WallClock().now());
    if (!count) return false;
    if (*count == 0) return true;
    all.insert(all.end(), some, some + *count);
  }
}

// Data, each with the command that came after it; an empty one after the last.
using TelnetStream = std::vector<std::pair<Wire, host::telnet::Command>>;

TelnetStream take_all(host::telnet::Reader& reader, Bytes wire) {
  TelnetStream all;
  while (auto command = reader.take(wire)) all.emplace_back(reader.take_data(), *command);
  all.emplace_back(reader.take_data(), host::telnet::Command{});
  return all;
}

TelnetStream take_in_pieces(host::telnet::Reader& reader, Bytes wire) {
  TelnetStream all(1);
  for (std::size_t i = 0; i < wire.size(); ++i) {
    Bytes piece = wire.subspan(i, 1);
    const auto command = reader.take(piece);
    const Wire data = reader.take_data();
    all.back().first.insert(all.back().first.end(), data.begin(), data.end());
    if (!command) continue;
    all.back().second = *command;
    all.emplace_back();
  }
  return all;
}

}  // namespace

// A hostile bus at either end of the link: after it a frame passes both ways.
Complaint try_can(Bytes bytes) {
  Choices choices(bytes);
  host::TestBus bus;
  const bool board = choices.below(2) == 1;
  host::CanLink::Options options;
  if (board) options = {.end = host::CanLink::End::board, .addresses = {1, 3}};
  auto link = host::CanLink::open(std::make_unique<host::TestCanSockets>(bus), options);
  if (!link) return link.error().message;
  const std::uint32_t send_id = (board ? host::kCanReplies : host::kCanRequests) + 1;
  if (!(*link)->write(frame_to(1))) return "the link rejected the first frame";
  while (!choices.ended()) {
    Wire expected, got;
    bool failed = false;
    switch (choices.below(4)) {
      case 0: {  // a message
        const Wire message = bytes_of(choices, choices.below(128) + 1);
        if (bus.far[send_id] && bus.deliver(send_id, message)) {
          expected.push_back(0);
          expected.insert(expected.end(), message.begin(), message.end());
          expected.push_back(0);
        }
        break;
      }
      case 1:
        (void)bus.error_frame(choices.word() & CAN_ERR_MASK, choices.byte());
        break;
      case 2:
        failed = !(*link)->write(bytes_of(choices, choices.below(200)));
        break;
      default:  // the sockets close, as those of an interface that is unplugged
        bus.far.erase(send_id);
        break;
    }
    // On a late machine, the link gives up a message after 0.2 s and opens a new socket; the bytes in the old
    // socket are lost.
    const int far = bus.far[send_id].get();
    failed = !read_all(**link, got) || failed;
    if (!failed && got != expected && bus.far[send_id].get() == far)
      return "the received bytes differ from the delivered bytes";
    if (failed && (*link)->read({}, host::WallClock().now()))
      return "a read from a lost link succeeded";
    if (failed && !(*link)->reopen()) return "an existing interface was not opened again";
    if (!bus.far[send_id] && !(*link)->write(frame_to(1))) return "a write to a new socket failed";
  }
  // One that ends what was begun; then a whole one.
  if (!(*link)->write(Wire{0})) return "the link rejected a zero byte";
  // A full socket leaves messages in the link, which sends them when it reads.
  for (Wire rest; !bus.received(send_id).empty();) {
    if (!read_all(**link, rest)) return "a read failed on a link without an error";
  }
  const Wire frame = frame_to(1);
  if (!(*link)->write(frame)) return "the link rejected a frame";
  if (bus.received(send_id) != Wire(frame.begin() + 1, frame.end() - 1))
    return "the frame did not arrive";
  Wire back;
  if (!bus.deliver(send_id, Wire(frame.begin() + 1, frame.end() - 1)) || !read_all(**link, back) ||
      back != frame)
    return "the delivered frame was not read unchanged";
  return std::nullopt;
}

Complaint try_telnet(Bytes bytes) {
  using namespace host::telnet;
  Reader whole, pieces;
  const TelnetStream all = take_all(whole, bytes), one_by_one = take_in_pieces(pieces, bytes);
  if (all != one_by_one || whole.dropped() != pieces.dropped())
    return "the result differs if the bytes arrive one by one";
  Options options;
  Wire answer;
  std::size_t count = 0;
  for (const auto& [data, command] : all) {
    count += data.size();
    if (command.data.size() > Reader::kMaxData) return "a command is longer than its limit";
    options.take(command, answer);
    (void)read_big_endian(command.data);
  }
  if (count > bytes.size()) return "more data bytes were returned than received";
  if (answer.size() > 3 * all.size()) return "the answers have more than three bytes per command";
  // Whatever was begun ends, and the next command is understood.
  (void)take_all(whole, Wire{kIac, kSe, kIac, kSe});
  Wire wire;
  put_com_port(kBaudRate, big_endian(57600), wire);
  put_data(bytes, wire);
  const auto next = take_all(whole, wire);
  const bool understood = next.size() == 2 && next[0].second.what == kBaudRate &&
                          read_big_endian(next[0].second.data) == 57600;
  if (!understood) return "a valid command after the input was not decoded";
  if (!std::ranges::equal(next[1].first, bytes))
    return "the decoded data differ from the encoded data";
  return std::nullopt;
}

Complaint try_boards(Bytes bytes) {
  const auto boards = tools::parse_boards("kaz.boards", text_of(bytes));
  if (!boards) return judge_error(boards.error(), "kaz.boards");
  std::uint32_t all = 0;
  for (const auto& board : *boards) {
    if (board.address < 1 || board.address > KZ_ADDRESS_LAST || board.port.place.empty())
      return "an invalid board";
    if ((all & board.joints) != 0) return "two boards have the same joint";
    all |= board.joints;
  }
  return all == host::kAllJoints ? std::nullopt : Complaint("no board has one of the joints");
}

}  // namespace kaz::fuzz
