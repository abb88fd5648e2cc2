// Applies events from an input equally to the chip in each engine.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/fuzz/engines.h"

namespace kaz::h8s::fuzz {
namespace {

std::string in_words(const Registers& r) {
  std::string text = "pc " + std::to_string(r.pc) + " ccr " + std::to_string(r.ccr) + " er";
  for (const std::uint32_t er : r.er) text.append(" ").append(std::to_string(er));
  return text;
}

// Without the last instructions: the translator lists those of the interpreter alone.
std::string without_history(const std::string& report) {
  const std::size_t from = report.find("\nlast instructions");
  if (from == std::string::npos) return report;
  std::size_t to = report.find('\n', from + 1);
  while (to != std::string::npos && report.compare(to, 3, "\n  ") == 0)
    to = report.find('\n', to + 1);
  return report.substr(0, from) + (to == std::string::npos ? "" : report.substr(to));
}

}  // namespace

Engines::Engines(Options options, const Image& image, std::uint8_t ram_fill) {
  std::vector<Engine> kinds{Engine::reference, Engine::interpreter};
  if (translator_available()) kinds.push_back(Engine::translator);
  for (const Engine kind : kinds) {
    options.engine = kind;
    Chip chip(options);
    (void)chip.load(image);
    chip.power_on(ram_fill);
    chip.set_analog([](int channel, States at) {
      return static_cast<double>((at / 64 + channel * 31) % 256) / 255;
    });
    chips_.push_back(std::move(chip));
  }
}

// One event outside the chip.
void Engines::event(Reader& input) {
  const std::uint8_t kind = input.byte(), value = input.byte();
  const auto port = static_cast<Port>(1 + kind / 16 % 7);
  const int bit = value & 7;
  const bool level = (value & 8) != 0;
  switch (kind % 16) {
    case 0:
    case 1:
    case 2:
    case 3:
    case 4:
      each([&](Chip& chip) { chip.set_input(port, bit, level); });
      break;
    case 5:
      each([&](Chip& chip) { chip.release_input(port, bit); });
      break;
    case 6:
      each([&](Chip& chip) { chip.set_nmi(level); });
      break;
    case 7:
    case 8:
    case 9: {
      const States wait = kind / 16 * 16;
      each([&](Chip& chip) {
        (void)chip.receive(value & 1,
                           {value, chip.now() + wait, (value & 2) != 0, (value & 4) != 0});
      });
      break;
    }
    case 10:
      each([](Chip& chip) { chip.reset(); });
      break;
    case 11:  // a copy goes on where the chip was
      each([](Chip& chip) { chip.restore(*chip.save()); });
      break;
    case 12:
      each([&](Chip& chip) {
        if (chip.run_until(chip.now()).reason == Stop::Reason::reached) chip.step();
      });
      break;
    default:
      break;
  }
}

std::string Engines::compare(const std::vector<Stop>& stops) const {
  const Chip& judge = chips_.front();
  for (std::size_t k = 1; k < chips_.size(); ++k) {
    const Chip& chip = chips_[k];
    const std::string who = "engine " + std::to_string(k) + ": ";
    if (stops[k].reason != stops[0].reason ||
        without_history(stops[k].report) != without_history(stops[0].report))
      return who + stops[k].report + "\nnot\n" + stops[0].report;
    if (chip.now() != judge.now())
      return who + "state " + std::to_string(chip.now()) + " not " + std::to_string(judge.now());
    if (!(chip.registers() == judge.registers()))
      return who + in_words(chip.registers()) + "\nnot\n" + in_words(judge.registers());
    if (chip.asleep() != judge.asleep()) return who + "asleep differs";
    if (chip.misuse().size() != judge.misuse().size()) return who + "misuse differs";
  }
  return {};
}

std::string Engines::compare_memory() const {
  for (std::uint32_t at = 0xe000; at < 0x10000; ++at) {
    const auto wanted = chips_.front().peek(0xff0000 | at);
    for (const Chip& chip : chips_) {
      if (chip.peek(0xff0000 | at) != wanted) return "memory differs at " + std::to_string(at);
    }
  }
  return {};
}

std::string Engines::play(Reader& input, States states) {
  const States end = chips_.front().now() + states;
  while (chips_.front().now() < end) {
    States until = end;
    if (!input.empty()) {
      until = std::min(end, chips_.front().now() + static_cast<States>(input.number(1)) * 8);
    }
    std::vector<Stop> stops;
    each([&](Chip& chip) { stops.push_back(chip.run_until(until)); });
    if (std::string wrong = compare(stops); !wrong.empty()) return wrong;
    const bool stopped = stops.front().reason != Stop::Reason::reached;
    if (stopped && input.empty()) break;
    if (!input.empty()) event(input);
  }
  return compare_memory();
}

}  // namespace kaz::h8s::fuzz
