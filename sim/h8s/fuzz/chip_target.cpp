// Any bytes as flash, RAM and events; bits of a working program flipped.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/fuzz/engines.h"

namespace kaz::h8s::fuzz {
namespace {

constexpr States kStates = 5'000;
constexpr std::uint32_t kCode = 0x400;

Options options_of(std::uint8_t bits) {
  Options o;
  o.mode = (bits & 1) != 0 ? 3 : 2;
  o.rte_holds_off = (bits & 2) != 0;
  o.wide_timer_bus = (bits & 4) == 0;
  o.stc_copies = (bits & 8) != 0;
  o.floating_level = (bits & 16) != 0;
  o.predecrement_stores_decremented = (bits & 64) == 0;
  o.subclock_states = (bits & 32) != 0 ? 305 : 0;
  return o;
}

}  // namespace

// Input: one byte of options, one of RAM fill, two for the number of event bytes; the events; then the
// program. Every vector points into it, so that all events are handled.
std::string chip(Bytes input) {
  Reader in(input);
  const Options options = options_of(in.byte());
  const std::uint8_t fill = in.byte();
  Reader events(in.take(in.number(2) % 0x400));
  const Bytes program = in.take(0x2000);
  Image image;
  Segment vectors{0, 0, "vectors", {}};
  const bool normal = options.mode == 3;
  const auto size = static_cast<std::uint32_t>(program.size());
  for (std::uint32_t v = 0; v < 104; ++v) {
    const std::uint32_t to = kCode + (v == 0 || size == 0 ? 0 : (v * 22 % size & ~1u));
    for (int shift = normal ? 8 : 24; shift >= 0; shift -= 8)
      vectors.bytes.push_back(static_cast<std::uint8_t>(to >> shift));
  }
  image.segments.push_back(std::move(vectors));
  image.segments.push_back({kCode, kCode, "program", {program.begin(), program.end()}});
  Engines engines(options, image, fill);
  engines.each([&](Chip& chip) {
    (void)chip.poke(0xffe100, program.first(std::min<std::size_t>(program.size(), 0x800)));
    Registers r = chip.registers();
    r.er = {0, 0xffe200, 0xffffac, 0xffff90, 0x10, 0xffe110, 0xffe300, 0xfff000};
    chip.set_registers(r);
  });
  return engines.play(events, kStates);
}

// Input: one byte for the number of bits to flip, three for each; then events.
std::string flipped(const Image& base, Bytes input) {
  Reader in(input);
  Image image = base;
  std::size_t total = 0;
  for (const Segment& s : image.segments) total += s.bytes.size();
  if (total == 0) return {};
  for (int left = in.byte() % 16; left > 0; --left) {
    std::size_t at = in.number(3);
    const auto mask = static_cast<std::uint8_t>(1u << at % 8);
    at = at / 8 % total;
    for (Segment& s : image.segments) {
      if (at < s.bytes.size()) {
        s.bytes[at] ^= mask;
        break;
      }
      at -= s.bytes.size();
    }
  }
  Engines engines(options_of(0), image, 0xa5);
  return engines.play(in, 10 * kStates);
}

}  // namespace kaz::h8s::fuzz
