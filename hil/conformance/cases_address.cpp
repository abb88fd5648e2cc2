// Cases of docs/reference/protocol.md, chapter Addresses.
// SPDX-License-Identifier: Apache-2.0
#include "hil/conformance/suite.h"

namespace kaz::hil {
namespace {

// Gives the board an address, and starts it anew.
void move_to(Board& board, int address, int shared_line) {
  board.done("unlock", Put().u16(KZ_KEY).u8(10));
  board.done("set_address", Put().u8(address).u8(shared_line), 3000);
  board.done("reset", Put().u16(KZ_KEY));
  board.address = static_cast<std::uint8_t>(address);
  board.wait(120);
}

// At another address, and back at its own whatever happens there.
template <class Then>
void while_at(Board& board, int wanted, int shared_line, Then then) {
  move_to(board, board.other_than_home(wanted), shared_line);
  try {
    then();
  } catch (...) {
    move_to(board, board.home(), 0);
    throw;
  }
  move_to(board, board.home(), 0);
}

void broadcast(Board& board, std::string_view name, const Bytes& fields) {
  const std::uint8_t own = board.address;
  board.address = KZ_ADDRESS_ALL;
  const Bytes wire = board.request_bytes(name, fields);
  board.address = own;
  board.write(wire);
  board.silence(15);
}

}  // namespace

void add_address_cases(Cases& all) {
  Chapter to(all, "address", kNothing);
  to.add(
      "default", "A board without a stored address replies at address 1.", "ADDR-1",
      [](Board& b) { equal("address", b.done("identify").frame().address, 1); }, kDefaultAddress);
  to.add("own", "A request to the board's address is answered from that address.", "ADDR-2",
         [](Board& b) {
           for (const char* name : {"identify", "state", "clear", "self_test"}) {
             equal("address", b.done(name).frame().address, b.address);
           }
           equal("board address in a refusal",
                 b.refused_type(0x7F, {}, KZ_REFUSED_UNKNOWN_TYPE).frame().address, b.address);
         });
  to.add("all-done", "A request to all boards is executed and not answered.", "ADDR-3",
         [](Board& b) {
           broadcast(b, "heartbeat", Put().u8(33).u8(KZ_REACTION_HOLD));
           const Reply who = b.done("identify");
           equal("watchdog", who["watchdog_10ms"], 33);
           equal("reaction", who["reaction"], KZ_REACTION_HOLD);
         });
  to.add("all-wrong", "An invalid request to all boards is not answered.", "ADDR-3", [](Board& b) {
    broadcast(b, "heartbeat", Put().u8(101).u8(0));
    broadcast(b, "heartbeat", Put().u8(1));
    broadcast(b, "read_targets", Put().u32(0x40000));
  });
  to.add("all-questions", "A query to all boards is not answered.", "ADDR-3", [](Board& b) {
    for (const char* name : {"identify", "state", "health", "statistics"}) broadcast(b, name, {});
  });
  for (int other = 0; other < 256; ++other) {
    const bool named = other == 0 || other == 2 || other == 14 || other == 16 || other == 255;
    if (!named) continue;
    to.add(("other-" + std::to_string(other)).c_str(),
           "A request to address " + std::to_string(other) +
               " is neither executed nor answered nor counted.",
           "ADDR-4", [other](Board& b) {
             const long before = b.statistics()["frames"];
             b.write(frame_of(b.other_than_home(other), KZ_TYPE_stop, b.new_sequence(), {}));
             b.silence(15);
             equal("shutdown reason", b.state().reason(), KZ_SHUTDOWN_NONE);
             equal("valid frames", b.statistics()["frames"] - before, 2);
           });
  }
  for (const int type : {0x81, 0x87, 0xC0, 0xFF, 0x80}) {
    to.add(("reply-type-" + std::to_string(type)).c_str(),
           "A frame of type " + std::to_string(type) +
               " is ignored, because bit 7 of the type is set.",
           "ADDR-5", [type](Board& b) {
             b.write(frame_of(b.address, static_cast<std::uint8_t>(type), b.new_sequence(), {}));
             b.silence(15);
             b.expect_alive();
           });
  }
  to.add(
      "set", "The address that `set_address` sets applies only after the next reset.", "ADDR-6",
      [](Board& b) {
        b.done("unlock", Put().u16(KZ_KEY).u8(10));
        const std::uint8_t other = b.other_than_home(9);
        b.done("set_address", Put().u8(other).u8(0), 3000);
        b.expect_alive();  // still here
        while_at(b, other, 0, [&] {
          b.expect_alive();
          b.address = b.home();
          const bool old = b.answers();
          b.address = other;
          check(!old, "the board still replies at its old address");
        });
        b.expect_alive();
      },
      kFlash);
  to.add(
      "set-last", "Address 14 can be set.", "ADDR-6",
      [](Board& b) { while_at(b, KZ_ADDRESS_LAST, 0, [&] { b.expect_alive(); }); }, kFlash);
  to.add(
      "shared-line",
      "On a shared line, telemetry is refused, and the board does not report the capability "
      "TELEMETRY.",
      "ADDR-7",
      [](Board& b) {
        check((b.done("identify")["capabilities"] & KZ_CAPABILITY_TELEMETRY) != 0,
              "the board does not report the capability TELEMETRY on an unshared line");
        while_at(b, 3, 1, [&] {
          check((b.done("identify")["capabilities"] & KZ_CAPABILITY_TELEMETRY) == 0,
                "the board reports the capability TELEMETRY on a shared line");
          b.refused("telemetry", Put().u16(100).u8(1), KZ_REFUSED_SHARED_LINE);
          check(b.telemetry(120, true).empty(), "the board sent telemetry on a shared line");
        });
        b.done("telemetry", Put().u16(100).u8(1));
      },
      kFlash);
}

}  // namespace kaz::hil
