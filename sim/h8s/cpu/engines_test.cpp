// The three engines held against each other: random programs cut into random slices.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <random>

#include "sim/h8s/chip/chip_testing.h"
#include "sim/h8s/cpu/opcode.h"

namespace kaz::h8s::testing {
namespace {

using Random = std::mt19937;

unsigned pick(Random& random, unsigned below) {
  return static_cast<unsigned>(random() % below);
}

constexpr std::uint32_t kRamProgram = 0xffe200;  // address of self-modifying programs

// A program of instructions out of the opcode table. Addresses are mostly in RAM, in ER4 to ER6;
// branches lead to instructions of the program, calls to short functions behind it.
class RandomProgram {
 public:
  RandomProgram(unsigned seed, std::uint32_t base, int length) : random_(seed), base_(base) {
    for (const auto group :
         {move_opcodes(), arithmetic_opcodes(), shift_opcodes(), bit_opcodes(), system_opcodes()}) {
      for (const Opcode& row : group) {
        const std::string name = row.name;
        if (name == "sleep" || name == "trapa" || name == "rte" || name == "ldc") continue;
        rows_.push_back(&row);
      }
    }
    for (int k = 0; k < length; ++k) any();
    branch(0, true);
    const std::size_t functions = starts_.size();
    for (int f = 0; f < 3; ++f) {
      functions_.push_back(starts_.size());
      for (unsigned k = pick(random_, 5); k > 0; --k)
        row(*rows_[pick(random_, unsigned(rows_.size()))]);
      start();
      words_.push_back(0x5470);
    }
    for (const Reference& r : references_) {
      const std::size_t to =
          r.call ? functions_[r.target % functions_.size()] : r.target % functions;
      const auto offset = static_cast<std::uint16_t>(2 * starts_[to] - 2 * (r.at + 2));
      if (r.absolute) {
        const std::uint32_t address = base_ + 2 * static_cast<std::uint32_t>(starts_[to]);
        words_[r.at] = static_cast<std::uint16_t>((words_[r.at] & 0xff00) | (address >> 16));
        words_[r.at + 1] = static_cast<std::uint16_t>(address);
      } else {
        words_[r.at + 1] = offset;
      }
    }
  }

  const std::vector<std::uint16_t>& words() const { return words_; }

 private:
  struct Reference {
    std::size_t at;  // of the branch
    unsigned target;
    bool call, absolute;
  };

  void start() { starts_.push_back(words_.size()); }

  void branch(unsigned target, bool always) {
    start();
    references_.push_back({words_.size(), target, false, false});
    words_.push_back(static_cast<std::uint16_t>(0x5800 | (always ? 0 : pick(random_, 16)) << 4));
    words_.push_back(0);
  }

  void call() {
    start();
    const bool absolute = pick(random_, 2) != 0;
    references_.push_back({words_.size(), pick(random_, 8), true, absolute});
    words_.push_back(absolute ? 0x5e00 : 0x5c00);
    words_.push_back(0);
  }

  // mov.l #address,ern ; jmp or jsr @ern
  void through_register() {
    start();
    const bool is_call = pick(random_, 3) != 0;
    const unsigned n = pick(random_, 4);
    words_.push_back(static_cast<std::uint16_t>(0x7a00 | n));
    references_.push_back({words_.size(), pick(random_, 64), is_call, true});
    words_.push_back(0);
    words_.push_back(0);
    words_.push_back(static_cast<std::uint16_t>((is_call ? 0x5d00 : 0x5900) | n << 4));
  }

  // mov.l #address,ern for the registers that point.
  void point() {
    start();
    words_.push_back(static_cast<std::uint16_t>(0x7a00 | (4 + pick(random_, 3))));
    std::uint32_t address = kRamData + pick(random_, 0x80);
    const unsigned where = pick(random_, 20);
    if (where == 0) address = 0x1000 + pick(random_, 64);      // flash
    if (where == 1) address = 0xffff00 + pick(random_, 0x70);  // short RAM
    if (where == 2) address = 0xffefe0 + pick(random_, 0x18);  // near the end of RAM
    if (where == 3) address = 0xffffb2;                        // a register
    if (where < 8) address |= static_cast<std::uint32_t>(random_()) << 24;
    words_.push_back(static_cast<std::uint16_t>(address >> 16));
    words_.push_back(static_cast<std::uint16_t>(address & ~(where == 9 ? 0u : 1u)));
  }

  void any() {
    const unsigned what = pick(random_, 100);
    if (what < 12) return branch(pick(random_, 64), false);
    if (what < 15) return call();
    if (what < 17) return through_register();
    if (what < 22) return point();
    row(*rows_[pick(random_, static_cast<unsigned>(rows_.size()))]);
  }

  // Low registers are computed in, high ones point.
  unsigned field(char ch) {
    const unsigned high = pick(random_, 30) == 0 ? 4 + pick(random_, 3) : pick(random_, 4);
    switch (ch) {
      case 'r':
      case 's':
      case 'u':
      case 'w':
        return high | pick(random_, 2) << 3;
      case 't':
      case 'p':
        return pick(random_, ch == 't' ? 8 : 4);
      case 'T':
        return 8 + pick(random_, 8);
      case 'm':
      case 'n':
        return high;
      case 'M':
      case 'N':
        return 8 | high;
      default:
        return pick(random_, 16);
    }
  }

  void row(const Opcode& opcode) {
    start();
    const std::string pattern = opcode.pattern, operands = opcode.operands;
    const std::string name = opcode.name;
    // Registers in parentheses or behind @ point to memory.
    const auto points = [&](char ch) {
      for (std::size_t k = 1; k < operands.size(); ++k) {
        if (operands[k] != ch || operands[k - 1] != '%') continue;
        const char before = k > 1 ? operands[k - 2] : ' ';
        if (before == '@' || before == '-' || before == ',') {
          const bool inside = operands.find('(') < k && operands.find(')') > k;
          if (before == '@' || before == '-' || inside) return true;
        }
      }
      return false;
    };
    if (name == "eepmov.b" || name == "eepmov.w") {  // short ones
      words_.insert(words_.end(), {0x7904, static_cast<std::uint16_t>(pick(random_, 9))});
      start();
    }
    const std::size_t first = words_.size();
    unsigned word = 0, nibbles = 0;
    for (const char ch : pattern) {
      if (ch == ' ') continue;
      unsigned nibble = 0;
      if (ch >= '0' && ch <= '9')
        nibble = static_cast<unsigned>(ch - '0');
      else if (ch >= 'A' && ch <= 'F')
        nibble = static_cast<unsigned>(ch - 'A' + 10);
      else if (points(ch))
        nibble =
            (pick(random_, 12) == 0 ? 7 : 4 + pick(random_, 3)) | (ch == 'N' || ch == 'M' ? 8 : 0);
      else
        nibble = field(ch);
      word = word << 4 | nibble;
      if (++nibbles % 4 == 0) words_.push_back(static_cast<std::uint16_t>(word));
    }
    const std::size_t a = pattern.find('a'), d = pattern.find('d');
    const auto last = words_.size() - 1;
    if (d != std::string::npos) {
      const int displacement = static_cast<int>(pick(random_, 32)) - 8;
      const std::size_t digits =
          static_cast<std::size_t>(std::count(pattern.begin(), pattern.end(), 'd'));
      words_[last] = static_cast<std::uint16_t>(displacement & ~1);
      if (digits == 8) words_[last - 1] = displacement < 0 ? 0xffff : 0;
    }
    if (a != std::string::npos) {
      const std::size_t digits =
          static_cast<std::size_t>(std::count(pattern.begin(), pattern.end(), 'a'));
      const std::size_t at =
          first + static_cast<std::size_t>(std::count(
                      pattern.begin(), pattern.begin() + static_cast<std::ptrdiff_t>(a), ' '));
      const unsigned choice = pick(random_, 12);
      std::uint32_t address = kRamData + 2 * pick(random_, 64);
      if (choice == 0) address = 0xffff10 + 2 * pick(random_, 16);
      if (choice == 1) address = 0x1000 + 2 * pick(random_, 16);
      if (choice == 2) address = 0xffe200 + 2 * pick(random_, 100);
      if (choice == 3) address = 0xffffb2;
      // A watchdog's counter: it shows the time of the access.
      if (choice == 4) address = name.ends_with(".b") ? 0xffffa9 : 0xffffa8;
      if (digits == 2) {
        words_[at] = static_cast<std::uint16_t>((words_[at] & 0xff00) | pick(random_, 0x70));
      } else if (digits == 4) {
        words_[at] = static_cast<std::uint16_t>(address);
      } else {
        words_[at] = static_cast<std::uint16_t>(address >> 16);
        words_[at + 1] = static_cast<std::uint16_t>(address);
      }
    }
  }

  Random random_;
  std::uint32_t base_;
  std::vector<const Opcode*> rows_;
  std::vector<std::uint16_t> words_;
  std::vector<std::size_t> starts_, functions_;
  std::vector<Reference> references_;
};

Chip chip_for(Engine engine, unsigned patience, const std::vector<std::uint16_t>& words,
              std::uint32_t base, const Registers& registers) {
  Options options;
  options.engine = engine;
  options.translate_after = patience;
  Chip chip = make_chip(Program(), options);
  const auto put = [&](std::uint32_t at, const std::vector<std::uint16_t>& what) {
    for (const std::uint16_t w : what) {
      chip.poke(at, static_cast<std::uint8_t>(w >> 8));
      chip.poke(at + 1, static_cast<std::uint8_t>(w));
      at += 2;
    }
  };
  put(base, words);
  // NMI: the handler counts in memory and returns. WDT0: clears its flag and returns.
  put(handler(7), {0x0a00, 0x5670});
  put(0x9f00, {0x6df0, 0x6a08, 0xffa8, 0x7900, 0xa520, 0x6b80, 0xffa8, 0x6d70, 0x5670});
  put(25 * 4, {0x0000, 0x9f00});
  chip.power_on();
  put(base, words);
  // The watchdog timer as interval timer: an interrupt every 512 states. Not in RAM: while no instruction
  // there has been decoded, the translator's stores do not look for any.
  Registers r = chip.registers();
  put(0x9f40, {0x7900, 0xa520, 0x6b80, 0xffa8});
  r.pc = 0x9f40;
  chip.set_registers(r);
  chip.step();
  chip.step();
  chip.set_registers(registers);
  return chip;
}

void compare(Chip& a, Chip& b, unsigned seed, int slice, const char* name) {
  const Registers ra = a.registers(), rb = b.registers();
  ASSERT_EQ(ra, rb) << name << ", seed " << seed << ", slice " << slice << "\n"
                    << a.report() << b.report();
  ASSERT_EQ(a.now(), b.now()) << name << ", seed " << seed << ", slice " << slice;
  ASSERT_EQ(a.instructions(), b.instructions()) << name << ", seed " << seed << ", slice " << slice;
}

void compare_memory(Chip& a, Chip& b, unsigned seed) {
  for (std::uint32_t at = 0xffe080; at < 0xfff000; ++at)
    ASSERT_EQ(a.peek(at), b.peek(at)) << "seed " << seed << " at " << std::hex << at;
  for (std::uint32_t at = 0xffff00; at < 0xffff80; ++at)
    ASSERT_EQ(a.peek(at), b.peek(at)) << "seed " << seed << " at " << std::hex << at;
}

void run_seed(unsigned seed, bool in_ram, int slices) {
  Random random(seed * 2654435761u + 1);
  const std::uint32_t base = in_ram ? kRamProgram : kCode;
  const RandomProgram program(seed, base, 20 + static_cast<int>(pick(random, 60)));
  Registers r;
  for (auto& e : r.er) e = static_cast<std::uint32_t>(random());
  for (unsigned n = 4; n < 7; ++n) r.er[n] = kRamData + 2 * pick(random, 64);
  if (in_ram && pick(random, 2)) r.er[5] = kRamProgram + 2 * pick(random, 64);
  r.er[7] = kStack - 0x400 + 2 * pick(random, 16);
  r.pc = base;
  r.ccr = static_cast<std::uint8_t>(random() & 0xff);
  Chip judge = chip_for(Engine::reference, 1, program.words(), base, r);
  Chip interpreter = chip_for(Engine::interpreter, 1, program.words(), base, r);
  Chip translator = chip_for(Engine::translator, 1 + pick(random, 4), program.words(), base, r);
  for (int slice = 0; slice < slices; ++slice) {
    const States to = judge.now() + 1 + pick(random, pick(random, 2) ? 60 : 1500);
    if (pick(random, 8) == 0) {
      const bool level = pick(random, 2) != 0;
      for (Chip* chip : {&judge, &interpreter, &translator}) chip->set_nmi(level);
    }
    const Stop stop = judge.run_until(to), stop_i = interpreter.run_until(to),
               stop_t = translator.run_until(to);
    compare(judge, interpreter, seed, slice, "interpreter");
    if (::testing::Test::HasFatalFailure()) return;
    compare(judge, translator, seed, slice, "translator");
    if (::testing::Test::HasFatalFailure()) return;
    ASSERT_EQ(stop.reason, stop_i.reason) << seed;
    ASSERT_EQ(stop.reason, stop_t.reason) << seed;
    if (stop.reason == Stop::Reason::asleep_forever) break;
    if (stop.reason != Stop::Reason::reached) {
      // Go on at the beginning, with pointers that point.
      for (Chip* chip : {&judge, &interpreter, &translator}) {
        chip->reset();
        Registers again = chip->registers();
        again.pc = base;
        again.ccr = r.ccr;
        for (unsigned n = 4; n < 8; ++n) again.er[n] = r.er[n];
        chip->set_registers(again);
      }
    }
    if (slice % 16 == 15) compare_memory(judge, translator, seed);
    if (::testing::Test::HasFatalFailure()) return;
  }
  compare_memory(judge, interpreter, seed);
  compare_memory(judge, translator, seed);
}

// Code hooks at random instructions, set and cleared on the way: each engine calls them at the same
// states with the same registers, and runs as without them. The translator goes on translating.
void run_hooked_seed(unsigned seed, bool in_ram, std::int64_t& translated) {
  Random random(seed * 2654435761u + 7);
  const std::uint32_t base = in_ram ? kRamProgram : kCode;
  const RandomProgram program(seed, base, 20 + static_cast<int>(pick(random, 60)));
  Registers r;
  for (auto& e : r.er) e = static_cast<std::uint32_t>(random());
  for (unsigned n = 4; n < 7; ++n) r.er[n] = kRamData + 2 * pick(random, 64);
  r.er[7] = kStack - 0x400 + 2 * pick(random, 16);
  r.pc = base;
  r.ccr = static_cast<std::uint8_t>(random() & 0xff);
  struct Seen {
    Registers registers;
    States at;
    bool operator==(const Seen&) const = default;
  };
  Chip plain = chip_for(Engine::interpreter, 1, program.words(), base, r);
  Chip hooked[] = {chip_for(Engine::reference, 1, program.words(), base, r),
                   chip_for(Engine::interpreter, 1, program.words(), base, r),
                   chip_for(Engine::translator, 1 + pick(random, 3), program.words(), base, r)};
  std::vector<Seen> seen[3];
  std::vector<std::uint32_t> set;
  for (int slice = 0; slice < 30; ++slice) {
    // Any word of the program: hooks inside an instruction are never reached, and harm nothing.
    const std::uint32_t at = base + 2 * pick(random, static_cast<unsigned>(program.words().size()));
    const bool clear = !set.empty() && pick(random, 3) == 0;
    const std::uint32_t gone = clear ? set[pick(random, static_cast<unsigned>(set.size()))] : 0;
    for (int n = 0; n < 3; ++n) {
      if (clear) hooked[n].clear_hook(gone);
      hooked[n].set_hook(at, [&seen, n, at](Chip& chip) {
        EXPECT_EQ(chip.registers().pc, at);
        seen[n].push_back({chip.registers(), chip.now()});
        return HookAction::go_on;
      });
    }
    set.push_back(at);
    const States to = plain.now() + 1 + pick(random, 1500);
    const Stop stop = plain.run_until(to);
    for (int n = 0; n < 3; ++n) {
      ASSERT_EQ(hooked[n].run_until(to).reason, stop.reason) << seed << ", engine " << n;
      compare(plain, hooked[n], seed, slice, name_of(hooked[n].engine()));
      if (::testing::Test::HasFatalFailure()) return;
      ASSERT_EQ(seen[n], seen[0]) << seed << ", engine " << n << ", slice " << slice;
    }
    if (stop.reason != Stop::Reason::reached) break;
  }
  for (Chip& chip : hooked) compare_memory(plain, chip, seed);
  translated += hooked[2].translated_instructions();
}

// More by hand: KAZ_ENGINE_SEEDS=first,count.
void seeds_of_environment(unsigned& first, unsigned& count) {
  if (const char* text = std::getenv("KAZ_ENGINE_SEEDS"))
    std::sscanf(text, "%u,%u", &first, &count);
}

void run_hooked_seeds(unsigned first, bool in_ram) {
  std::int64_t translated = 0;
  unsigned count = 60;
  seeds_of_environment(first, count);
  for (unsigned seed = first; seed < first + count; ++seed) {
    run_hooked_seed(seed, in_ram, translated);
    if (::testing::Test::HasFatalFailure()) return;
  }
  if (translator_available()) {
    EXPECT_GT(translated, 10'000);
  }
}

void run_seeds(unsigned first, unsigned count, bool in_ram) {
  seeds_of_environment(first, count);
  for (unsigned seed = first; seed < first + count; ++seed) {
    run_seed(seed, in_ram, 40);
    if (::testing::Test::HasFatalFailure()) return;
  }
}

// Repeated power cycles: each discards the translated code, here so much that it takes several parts of
// the host's memory.
TEST(Engines, AgreeAfterEachPowerOn) {
  std::vector<std::uint16_t> words;
  for (int k = 0; k < 6000; ++k) {
    words.push_back(0x0b50);  // inc.w #1,r0
    words.push_back(0x0901);  // add.w r0,r1
  }
  words.insert(words.end(), {0x5a00, static_cast<std::uint16_t>(kCode)});  // jmp to the start
  const auto run = [&words](Engine engine) {
    Options options;
    options.engine = engine;
    options.translate_after = 1;
    Chip chip = make_chip(words, options);
    std::vector<Registers> seen;
    for (int k = 0; k < 4; ++k) {
      chip.power_on();
      EXPECT_EQ(chip.run_until(chip.now() + 50'000).reason, Stop::Reason::reached);
      seen.push_back(chip.registers());
    }
    return seen;
  };
  EXPECT_EQ(run(Engine::translator), run(Engine::interpreter));
}

TEST(Engines, AgreeOnRandomProgramsInFlash) {
  run_seeds(1, 60, false);
}

TEST(Engines, AgreeWithCodeHooks) {
  run_hooked_seeds(1, false);
  run_hooked_seeds(1000, true);
}

// A hook in the middle of a loop that is translated already, and away again.
TEST(Engines, AHookInTranslatedCodeIsCalledEachTime) {
  Options options;
  options.translate_after = 1;
  // inc.w #1,r0 ; inc.w #1,r1 ; inc.w #1,r2 ; bra back
  Chip chip = make_chip({0x0b50, 0x0b51, 0x0b52, 0x40f8}, options);
  const States start = chip.now();
  chip.run_until(start + 5000);
  if (translator_available()) {
    EXPECT_GT(chip.translated_instructions(), 3000);
  }
  int calls = 0;
  chip.set_hook(kCode + 2, [&calls](Chip&) {
    ++calls;
    return HookAction::go_on;
  });
  const std::int64_t hooked_from = chip.translated_instructions();
  chip.run_until(start + 10000);  // 5 states a turn
  EXPECT_EQ(calls, 1000);
  if (translator_available()) {
    EXPECT_GT(chip.translated_instructions() - hooked_from, 2000);
  }
  chip.clear_hook(kCode + 2);
  chip.run_until(start + 15000);
  EXPECT_EQ(calls, 1000);
  EXPECT_EQ(chip.now() - start, 15000);
}

TEST(Engines, AgreeOnRandomProgramsThatChangeThemselves) {
  run_seeds(1000, 60, true);
  run_seeds(5231, 1, true);  // an EEPMOV.W over its own translated code
}

}  // namespace
}  // namespace kaz::h8s::testing
