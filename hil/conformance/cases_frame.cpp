// Cases of docs/reference/protocol.md, chapter Frame.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "hil/conformance/suite.h"

namespace kaz::hil {
namespace {

// A frame that is whole but for what is done to it; `heartbeat` has two bytes of fields.
Bytes valid_frame(Board& board, std::uint8_t& sequence) {
  sequence = board.new_sequence();
  return board.request_bytes("heartbeat", Put().u8(0).u8(0), sequence);
}

Bytes random_bytes(Board& board, int count, int lowest) {
  Bytes bytes;
  for (int i = 0; i < count; ++i) {
    bytes.push_back(static_cast<std::uint8_t>(
        lowest + static_cast<int>(board.random()() % static_cast<unsigned>(256 - lowest))));
  }
  return bytes;
}

void append(Bytes& to, const Bytes& more) {
  for (const std::uint8_t byte : more) to.push_back(byte);
}

// `junk` and at once a valid frame, which must be answered, and nothing else.
void answered_after(Board& board, Bytes junk) {
  std::uint8_t sequence;
  append(junk, valid_frame(board, sequence));
  board.write(junk);
  board.take("heartbeat", sequence);
  board.silence(10);
}

// Bytes that must be dropped, counted by `cause` alone, and not answered.
void dropped_as(Board& board, const Bytes& bytes, const char* cause) {
  static const char* const causes[] = {"bad_check", "bad_stuffing", "too_short",
                                       "too_long",  "line_errors",  "idle"};
  const Reply before = board.statistics();
  board.write(bytes);
  board.silence(30);
  const Reply after = board.statistics();
  for (const char* one : causes) {
    equal(std::string("count of ") + one, after[one] - before[one], std::string(one) == cause);
  }
  equal("valid frames", after["frames"] - before["frames"], 1);  // the second question
}

// One byte of the frame damaged at each place in turn; the first zero too.
void damage_each_byte(Board& board, std::uint8_t change) {
  std::uint8_t sequence;
  const Bytes whole = valid_frame(board, sequence);
  for (std::size_t at = 0; at + 1 < whole.size(); ++at) {
    Bytes damaged = whole;
    damaged[at] = static_cast<std::uint8_t>(damaged[at] ^ change);
    board.write(damaged);
    board.silence(6);
    board.write({0});
    board.silence(3);
  }
  board.expect_alive();
}

// Damages valid frames at random places; the whole frame that follows must be answered.
template <class Damage>
void damaged_then_whole(Board& board, Damage damage) {
  for (int n = 0; n < 20; ++n) {
    std::uint8_t sequence;
    Bytes wire = valid_frame(board, sequence);
    damage(wire, 1 + board.random()() % (wire.size() - 2));
    append(wire, valid_frame(board, sequence));
    board.write(wire);
    // Where the damage fell between two frames both are whole.
    while (true) {
      const auto frame = board.next(30 + static_cast<int>(board.slack().count() / 250'000));
      check(frame.has_value(), "the intact frame after a damaged frame is not answered");
      if (frame->sequence == sequence) break;
    }
    board.silence(3);
  }
}

void add_before(Chapter& to) {
  to.add("zeros-around", "Each reply begins with a zero byte and ends with another zero byte.",
         "FRAME-1", [](Board& b) {
           for (const char* name : {"identify", "state", "statistics", "health"}) b.done(name);
           b.refused_type(0x7F, {}, KZ_REFUSED_UNKNOWN_TYPE);
           equal("bytes outside of frames", b.wild_bytes(), 0);
         });
  to.add("zeros-around-back-to-back", "Two consecutive replies do not share a zero byte.",
         "FRAME-1", [](Board& b) {
           const std::uint8_t first = b.new_sequence(), second = b.new_sequence();
           Bytes wire = b.request_bytes("state", {}, first);
           append(wire, b.request_bytes("health", {}, second));
           b.write(wire);
           b.take("state", first);
           b.take("health", second);
           equal("bytes outside of frames", b.wild_bytes(), 0);
         });
  to.add("noise-before", "Noise before the first zero byte is ignored.", "FRAME-2", [](Board& b) {
    for (int n = 0; n < 10; ++n) answered_after(b, random_bytes(b, 1 + n * 5, 1));
  });
  to.add("half-frame-before", "An incomplete frame before a valid frame is ignored.", "FRAME-2",
         [](Board& b) {
           std::uint8_t sequence;
           const Bytes whole = valid_frame(b, sequence);
           for (std::size_t cut = 1; cut + 1 < whole.size(); ++cut) {
             answered_after(b, {whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(cut)});
           }
         });
  to.add("tail-before",
         "If only the tail of a frame arrives before a valid frame, the tail is ignored.",
         "FRAME-2", [](Board& b) {
           std::uint8_t sequence;
           const Bytes whole = valid_frame(b, sequence);
           for (std::size_t cut = 2; cut < whole.size(); ++cut) {
             answered_after(b, {whole.begin() + static_cast<std::ptrdiff_t>(cut), whole.end()});
           }
         });
  to.add("zeros-between", "Any number of zero bytes before a frame is ignored.", "FRAME-3",
         [](Board& b) {
           const Reply before = b.statistics();
           answered_after(b, Bytes(1, 0));
           answered_after(b, Bytes(2, 0));
           answered_after(b, Bytes(300, 0));
           const Reply after = b.statistics();
           equal("frames that were too short", after["too_short"] - before["too_short"], 0);
           equal("frames with a wrong CRC", after["bad_check"] - before["bad_check"], 0);
         });
  to.add("shared-zero", "The same zero byte can end a frame and begin the next frame.", "FRAME-3",
         [](Board& b) {
           std::uint8_t first, second;
           Bytes wire = valid_frame(b, first);
           const Bytes other = valid_frame(b, second);
           wire.insert(wire.end(), other.begin() + 1, other.end());
           b.write(wire);
           b.take("heartbeat", first);
           b.take("heartbeat", second);
         });
}

void add_damage(Chapter& to) {
  to.add("one-bit", "A frame with one flipped bit in any byte is not answered.", "FRAME-4",
         [](Board& b) { damage_each_byte(b, 0x01); });
  to.add("one-byte", "A frame with any one byte inverted is not answered.", "FRAME-4",
         [](Board& b) { damage_each_byte(b, 0xFF); });
  to.add("not-done", "A damaged `stop` is not executed.", "FRAME-4", [](Board& b) {
    for (std::size_t at = 1; at < 8; ++at) {
      Bytes wire = b.request_bytes("stop");
      wire[at] = static_cast<std::uint8_t>(wire[at] ^ 0x10);
      b.write(wire);
      b.write({0});
      b.silence(5);
    }
    equal("shutdown reason", b.state().reason(), KZ_SHUTDOWN_NONE);
  });
  to.add("damaged-then-whole", "After a damaged byte, the next intact frame is received.",
         "FRAME-5", [](Board& b) {
           damaged_then_whole(b, [&](Bytes& wire, std::size_t at) {
             wire[at] = static_cast<std::uint8_t>(wire[at] ^ (1 + b.random()() % 255));
           });
         });
  to.add("lost-then-whole", "After a lost byte, the next intact frame is received.", "FRAME-5",
         [](Board& b) {
           damaged_then_whole(b, [](Bytes& wire, std::size_t at) {
             wire.erase(wire.begin() + static_cast<std::ptrdiff_t>(at));
           });
         });
  to.add("inserted-then-whole", "After an inserted byte, the next intact frame is received.",
         "FRAME-5", [](Board& b) {
           damaged_then_whole(b, [&](Bytes& wire, std::size_t at) {
             wire.insert(wire.begin() + static_cast<std::ptrdiff_t>(at),
                         static_cast<std::uint8_t>(b.random()()));
           });
         });
  to.add("lost-zero-then-whole",
         "If the zero byte at the end of a frame is lost, the next frame is still received.",
         "FRAME-5", [](Board& b) {
           std::uint8_t first, second;
           Bytes wire = valid_frame(b, first);
           wire.pop_back();
           append(wire, valid_frame(b, second));
           b.write(wire);
           b.take("heartbeat", first);  // the next frame's zero ended it
           b.take("heartbeat", second);
         });
  to.add("burst-then-whole",
         "After a burst of 20 damaged bytes, the next intact frame is received.", "FRAME-5",
         [](Board& b) {
           for (int n = 0; n < 20; ++n) {
             std::uint8_t sequence;
             Bytes wire = b.request_bytes("read_targets", Put().u32(0x01010101 & KZ_ALL_JOINTS));
             append(wire, random_bytes(b, 20, 0));
             append(wire, valid_frame(b, sequence));
             b.write(wire);
             bool answered = false;
             while (const auto frame = b.next(30)) answered |= frame->sequence == sequence;
             check(answered, "the frame after a burst is not answered");
           }
         });
}

void add_counts(Chapter& to) {
  to.add("bad-check", "A frame with a wrong CRC is dropped and counted.", "FRAME-6", [](Board& b) {
    for (int place = 2; place <= 4; ++place) {
      Bytes wire = b.request_bytes("heartbeat", Put().u8(0).u8(0));
      wire[wire.size() - static_cast<std::size_t>(place)] ^= 0x01;
      dropped_as(b, wire, "bad_check");
    }
  });
  to.add("bad-check-high-bits",
         "A frame with a CRC whose upper bits are wrong is dropped and counted.", "FRAME-6",
         [](Board& b) {
           Bytes wire = b.request_bytes("heartbeat", Put().u8(0).u8(0));
           wire[wire.size() - 4] ^= 0x40;
           dropped_as(b, wire, "bad_check");
           wire = b.request_bytes("heartbeat", Put().u8(0).u8(0));
           wire[wire.size() - 2] ^= 0x80;
           if (wire[wire.size() - 2] != 0) dropped_as(b, wire, "bad_check");
         });
  to.add("check-of-body",
         "A frame whose CRC was computed from the unstuffed bytes is dropped and counted.",
         "FRAME-6", [](Board& b) {
           const Bytes body{b.home(), KZ_TYPE_heartbeat, b.new_sequence(), 0, 0};
           Bytes wire{0};
           append(wire, stuff(body));
           append(wire, check_of(crc_of(body)));
           wire.push_back(0);
           dropped_as(b, wire, "bad_check");
         });
  to.add("bad-stuffing",
         "A frame with a block that extends beyond the frame's end is dropped and counted.",
         "FRAME-7", [](Board& b) {
           Bytes stuffed = stuff({b.home(), KZ_TYPE_identify, b.new_sequence()});
           stuffed[0] = static_cast<std::uint8_t>(stuffed[0] + 1);
           dropped_as(b, frame_of_stuffed(stuffed), "bad_stuffing");
           stuffed[0] = 0xFF;
           dropped_as(b, frame_of_stuffed(stuffed), "bad_stuffing");
         });
  to.add("bad-stuffing-last", "A frame whose last block lacks one byte is dropped and counted.",
         "FRAME-7", [](Board& b) {
           Bytes stuffed = stuff({b.home(), KZ_TYPE_heartbeat, 7, 0, 5});
           stuffed.pop_back();
           dropped_as(b, frame_of_stuffed(stuffed), "bad_stuffing");
         });
  for (int length = 0; length < KZ_HEADER_SIZE; ++length) {
    to.add(("too-short-" + std::to_string(length)).c_str(),
           "A frame with a body shorter than the header is dropped and counted.", "FRAME-8",
           [length](Board& b) {
             Bytes body{b.home(), KZ_TYPE_identify};
             body.resize(static_cast<std::size_t>(length));
             dropped_as(b, frame_of_stuffed(stuff(body)), "too_short");
           });
  }
  for (int bytes = 1; bytes <= 3; ++bytes) {
    to.add(("too-short-raw-" + std::to_string(bytes)).c_str(),
           "A frame too short for a CRC is dropped and counted.", "FRAME-8", [bytes](Board& b) {
             Bytes wire(static_cast<std::size_t>(bytes) + 2, 0x85);
             wire.front() = wire.back() = 0;
             dropped_as(b, wire, "too_short");
           });
  }
  to.add("longest", "A frame with the longest body is received.", "FRAME-9", [](Board& b) {
    const Bytes fields = random_bytes(b, KZ_PAYLOAD_MAX, 0);
    b.refused_type(KZ_TYPE_identify, fields, KZ_REFUSED_LENGTH);
  });
  to.add("too-long", "A frame whose body is one byte longer than allowed is dropped and counted.",
         "FRAME-9", [](Board& b) {
           Bytes body{b.home(), KZ_TYPE_identify, b.new_sequence()};
           append(body, random_bytes(b, KZ_PAYLOAD_MAX + 1, 0));
           dropped_as(b, frame_of_stuffed(stuff(body)), "too_long");
         });
  to.add("much-too-long",
         "A frame of 2,000 bytes is dropped and counted once, and the board still replies.",
         "FRAME-9", [](Board& b) {
           Bytes wire(2000, 0x55);
           wire.front() = wire.back() = 0;
           const Reply before = b.statistics();
           b.write(wire);
           b.silence(220);
           equal("count of too_long", b.statistics()["too_long"] - before["too_long"], 1);
           b.expect_alive();
         });
  to.add(
      "line-error", "A frame that contains a byte with a framing error is dropped and counted.",
      "FRAME-10",
      [](Board& b) {
        const Reply before = b.statistics();
        std::uint8_t sequence;
        const Bytes wire = valid_frame(b, sequence);
        for (std::size_t at = 1; at + 1 < wire.size(); ++at) {
          b.write({wire.begin(), wire.begin() + static_cast<std::ptrdiff_t>(at)});
          b.bench().write_damaged({wire.data() + at, 1});
          b.write({wire.begin() + static_cast<std::ptrdiff_t>(at) + 1, wire.end()});
          b.silence(6);
        }
        const Reply after = b.statistics();
        equal("count of line_errors", after["line_errors"] - before["line_errors"],
              static_cast<long>(wire.size()) - 2);
        equal("count of bad_check", after["bad_check"] - before["bad_check"], 0);
      },
      kBench);
  to.add(
      "break", "A zero byte with a framing error (a break) does not end a frame.", "FRAME-10",
      [](Board& b) {
        std::uint8_t sequence;
        Bytes wire = valid_frame(b, sequence);
        wire.pop_back();
        b.write(wire);
        const Bytes zero{0};
        b.bench().write_damaged(zero);
        b.silence(6);
        const Reply after = b.statistics();  // its first zero ends what was damaged
        equal("count of line_errors", after["line_errors"], 1);
      },
      kBench);
  to.add(
      "idle", "If no byte arrives for 20 ms, an unfinished frame is dropped and counted.",
      "FRAME-11",
      [](Board& b) {
        const Reply before = b.statistics();
        std::uint8_t sequence;
        const Bytes wire = valid_frame(b, sequence);
        b.write({wire.begin(), wire.begin() + 4});
        b.wait(24);
        b.write({wire.begin() + 4, wire.end()});
        b.silence(20);
        const Reply after = b.statistics();
        equal("count of idle", after["idle"] - before["idle"], 1);
        equal("count of bad_check", after["bad_check"] - before["bad_check"], 0);
      },
      kPauses);
  to.add(
      "idle-then-whole",
      "After a frame was dropped because of a pause, the next frame is received.", "FRAME-11",
      [](Board& b) {
        std::uint8_t sequence;
        const Bytes wire = valid_frame(b, sequence);
        b.write({wire.begin(), wire.begin() + 6});
        b.wait(40);
        b.done("identify");
      },
      kPauses);
}

void add_contents(Chapter& to) {
  for (int place = 0; place < 6; ++place) {
    to.add(("zero-at-" + std::to_string(place)).c_str(),
           "A zero byte at position " + std::to_string(place) + " of the fields is received.",
           "FRAME-12", [place](Board& b) {
             Bytes fields(6, 0x5A);
             fields[static_cast<std::size_t>(place)] = 0;
             b.refused_type(KZ_TYPE_state, fields, KZ_REFUSED_LENGTH);
           });
  }
  to.add("every-sequence", "Every sequence number is returned unchanged, including 0 and 255.",
         "FRAME-12", [](Board& b) {
           for (int sequence = 0; sequence < 256; ++sequence) {
             b.write(b.request_bytes("clear", {}, static_cast<std::uint8_t>(sequence)));
             b.take("clear", static_cast<std::uint8_t>(sequence));
           }
         });
  to.add("every-value", "Every byte value in the fields is received unchanged.", "FRAME-12",
         [](Board& b) {
           // `lower` = `upper` beyond the mechanics is cut, so only values inside come back.
           for (int value = -700; value <= 700; value += 23) {
             b.done("limits", Put().u32(1).u16(60).s16(value).s16(value));
             const Reply set = b.done("settings", Put().u8(0));
             equal("lower limit", set["lower"], value);
             equal("upper limit", set["upper"], value);
           }
         });
  to.add("all-zeros", "A request with only zeros in its fields is received.", "FRAME-12",
         [](Board& b) {
           b.done("targets", Bytes(6, 0));
           b.done("gains", Bytes(11, 0));
         });
  to.add("random-contents", "200 frames with random contents are all received.", "FRAME-12",
         [](Board& b) {
           for (int n = 0; n < 200; ++n) {
             const int length = 1 + static_cast<int>(b.random()() % KZ_PAYLOAD_MAX);
             b.refused_type(KZ_TYPE_identify, random_bytes(b, length, 0), KZ_REFUSED_LENGTH);
           }
         });
  to.add(
      "slow-bytes", "A frame with pauses of 10 ms between its bytes is received.", "FRAME-13",
      [](Board& b) {
        std::uint8_t sequence;
        for (const std::uint8_t byte : valid_frame(b, sequence)) {
          b.write({byte});
          b.wait(10);
        }
        b.take("heartbeat", sequence);
      },
      kPauses);
  to.add(
      "slowest-bytes", "A frame with pauses of 18 ms between its bytes is received.", "FRAME-13",
      [](Board& b) {
        std::uint8_t sequence;
        for (const std::uint8_t byte : valid_frame(b, sequence)) {
          b.write({byte});
          b.wait(18);
        }
        b.take("heartbeat", sequence);
      },
      kExact | kPauses);
}

}  // namespace

void add_frame_cases(Cases& all) {
  Chapter to(all, "frame", kNothing);
  add_before(to);
  add_damage(to);
  add_counts(to);
  add_contents(to);
}

}  // namespace kaz::hil
