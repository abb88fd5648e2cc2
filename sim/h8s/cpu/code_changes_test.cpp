// Programs that change their own instructions, on each engine, against the tests' own model.
// SPDX-License-Identifier: Apache-2.0
//
// The model fetches every instruction from its memory when it runs it: a store into code counts from
// the next instruction on, be that the one right behind the store.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "sim/h8s/chip/chip_testing.h"
#include "sim/h8s/cpu/oracle_testing.h"

namespace kaz::h8s::oracle {
namespace {

constexpr u32 kStart = 0xffe200, kBase = 0xffe000, kTable = 0xffe100, kUnused = 0xffe180;

bool has(const Form& form, const char* part) {
  return form.name.find(part) != std::string::npos;
}

// Instructions of one unit on registers, of which one may replace another.
bool replaceable(const Form& f) {
  if (f.units() != 1 || f.cycles.l + f.cycles.m + f.cycles.k[1] + f.cycles.j[1] > 0) return false;
  for (const char* name :
       {"bcc", "jmp", "jsr", "bsr", "sleep", "daa", "das", "exr", "ccr", "divx"}) {
    if (has(f, name)) return false;
  }
  return true;
}

// A loop in RAM that stores instructions over some of its instructions, in front of the store and
// behind it: by words, longwords, bytes, bits, STM and block moves. ER4 to ER7 serve the stores.
class Program {
 public:
  explicit Program(u32 seed) : random_(seed) {
    for (const Form& f : forms()) {
      if (replaceable(f)) pool_.push_back(&f);
    }
    for (u32 k = 8 + pick(16); k-- > 0;) {
      if (pick(4) == 0) patch(pick(7));
      plain(1 + pick(4));
      if (pick(6) == 0) {  // a branch over one of them
        words_.push_back(static_cast<u16>(0x4002 | pick(16) << 8));
        plain(1);
      }
    }
    words_.push_back(0x5800);  // bra to the beginning
    words_.push_back(static_cast<u16>(-2 * static_cast<int>(words_.size()) - 2));
    for (Group& group : groups_) group.to = place_for(group);
    for (const Fixup& f : fixups_) {
      const u32 address = groups_[f.group].to + f.offset;
      if (f.wide) words_[f.at - 1] = static_cast<u16>(address >> 16);
      words_[f.at] = static_cast<u16>(address);
    }
    for (u32 k = 0; k < 16; ++k) table_.push_back(one());
  }

  const std::vector<u16>& words() const { return words_; }
  const std::vector<u16>& table() const { return table_; }  // what block moves copy from

 private:
  // Consecutive instructions that a store replaces, and the store's position.
  struct Group {
    u32 count;
    std::size_t from;
    u32 to = 0;
  };
  // A unit, or two, that holds the group's address and `offset`.
  struct Fixup {
    std::size_t at, group;
    u32 offset;
    bool wide;
  };

  u32 pick(u32 below) { return static_cast<u32>(random_() % below); }
  void code(std::initializer_list<u16> words) { words_.insert(words_.end(), words); }

  u16 one() {
    for (;;) {
      const Form& form = *pool_[pick(static_cast<u32>(pool_.size()))];
      Fields f;
      for (u32& value : f.value) value = static_cast<u32>(random_());
      const std::vector<u16> units = encode(form, f);
      if (form.fields(units)['d'] % 8 < 4) return units[0];
    }
  }

  void plain(u32 count) {
    while (count-- > 0) {
      starts_.push_back(words_.size());
      words_.push_back(one());
    }
  }

  u32 place_for(const Group& group) {
    std::vector<std::size_t> fit;
    for (std::size_t k = 0; k + group.count <= starts_.size(); ++k) {
      if (starts_[k + group.count - 1] == starts_[k] + group.count - 1) fit.push_back(starts_[k]);
    }
    if (fit.empty()) return kUnused;
    std::size_t to = fit[pick(static_cast<u32>(fit.size()))];
    if (pick(2) == 0) {  // right behind the store
      const auto next =
          std::find_if(fit.begin(), fit.end(), [&](auto at) { return at >= group.from; });
      if (next != fit.end()) to = *next;
    }
    return kStart + 2 * static_cast<u32>(to);
  }

  void address(bool wide, u32 offset) {
    if (wide) words_.push_back(0);
    fixups_.push_back({words_.size(), groups_.size() - 1, offset, wide});
    words_.push_back(0);
  }
  void replace(u32 count) { groups_.push_back({count, words_.size()}); }

  void patch(u32 kind) {
    static constexpr u32 kCount[] = {1, 1, 2, 2, 1, 3, 4};
    replace(kCount[kind]);
    switch (kind) {
      case 0:  // mov.w #new,r4 ; mov.w r4,@aa:16
        code({0x7904, one(), 0x6b84});
        address(false, 0);
        break;
      case 1:  // mov.w #new,e4 ; mov.l #at,er5 ; mov.w e4,@er5
        code({0x790c, one(), 0x7a05});
        address(true, 0);
        code({0x69dc});
        break;
      case 2:  // mov.l #new,er4 ; mov.l #at+4,er5 ; mov.l er4,@-er5
        code({0x7a04, one(), one(), 0x7a05});
        address(true, 4);
        code({0x0100, 0x6dd4});
        break;
      case 3:  // mov.l #new,er4 ; mov.l er4,@aa:32
        code({0x7a04, one(), one(), 0x0100, 0x6ba4});
        address(true, 0);
        break;
      case 4:  // an add.b #,rnh there, its immediate replaced, one bit of that inverted
        code({0x7904, static_cast<u16>(0x8000 | pick(4) << 8 | pick(256)), 0x6b84});
        address(false, 0);
        code({static_cast<u16>(0xfc00 | pick(256)), 0x6a8c});
        address(false, 1);
        code({0x6a18});
        address(false, 1);
        code({static_cast<u16>(0x7100 | pick(8) << 4)});
        break;
      case 5:  // mov.b #2..6,r4l ; mov.l #table+,er5 ; mov.l #at,er6 ; eepmov.b
        code({static_cast<u16>(0xfc00 | 2 * (1 + pick(3))), 0x7a05, 0x00ff,
              static_cast<u16>(kTable + 2 * pick(12)), 0x7a06});
        address(true, 0);
        code({0x7b5c, 0x598f});
        break;
      default:  // stm.l (er4-er5) with ER7 behind the place; ER7 is kept in ER6
        code({0x0ff6, 0x7a04, one(), one(), 0x7a05, one(), one(), 0x7a07});
        address(true, 8);
        code({0x0110, 0x6df4, 0x0fe7});
        break;
    }
    groups_.back().from = words_.size();
  }

  std::mt19937 random_;
  std::vector<const Form*> pool_;
  std::vector<u16> words_, table_;
  std::vector<std::size_t> starts_;
  std::vector<Group> groups_;
  std::vector<Fixup> fixups_;
};

class Model {
 public:
  Model() : ram_(0x2000, 0) {
    w.read = [this](u32 a) { return ram_[(a - kBase) & 0x1fff]; };
    w.write = [this](u32 a, u8 v) { ram_[(a - kBase) & 0x1fff] = v; };
  }
  void put(u32 at, const std::vector<u16>& units) {
    for (const u16 unit : units) {
      ram_[at++ - kBase] = static_cast<u8>(unit >> 8);
      ram_[at++ - kBase] = static_cast<u8>(unit);
    }
  }
  void run_until(States until) {
    while (now < until) {
      std::array<u16, 5> units{};
      for (std::size_t k = 0; k < 5; ++k) {
        const std::size_t at = w.pc - kBase + 2 * k;
        units[k] = static_cast<u16>(ram_[at] << 8 | ram_[at + 1]);
      }
      const Form* form = find(units);
      ASSERT_NE(form, nullptr) << std::hex << w.pc;
      now += step(w, *form, units);
    }
  }
  u8 byte(u32 address) const { return ram_[address - kBase]; }

  World w;
  States now = 0;

 private:
  std::vector<u8> ram_;
};

class CodeChanges : public ::testing::TestWithParam<Engine> {};

INSTANTIATE_TEST_SUITE_P(Engines, CodeChanges,
                         ::testing::Values(Engine::reference, Engine::interpreter,
                                           Engine::translator),
                         [](const auto& engine) { return name_of(engine.param); });

TEST_P(CodeChanges, CountFromTheNextInstructionOn) {
  std::int64_t translated = 0;
  for (u32 seed = 1; seed <= 300; ++seed) {
    const Program program(seed);
    std::mt19937 random(seed);
    Options options;
    options.engine = GetParam();
    options.translate_after = 1;
    Chip chip = testing::make_chip(std::vector<u16>{}, options);
    Model model;
    for (u32 at = 0xffe080; at < 0xfff000; ++at) chip.poke(at, 0);
    const auto put = [&](u32 at, const std::vector<u16>& units) {
      model.put(at, units);
      for (const u16 unit : units) {
        chip.poke(at++, static_cast<u8>(unit >> 8));
        chip.poke(at++, static_cast<u8>(unit));
      }
    };
    put(kStart, program.words());
    put(kTable, program.table());
    Registers r = chip.registers();
    for (u32& er : r.er) er = static_cast<u32>(random());
    r.er[7] = 0xffee00;
    r.pc = kStart;
    chip.set_registers(r);
    model.w.er = r.er;
    model.w.pc = r.pc;
    model.w.set_ccr(r.ccr);
    for (int k = 0; k < 40; ++k) {
      const States until = chip.now() + static_cast<States>(random() % (k % 4 == 0 ? 1500 : 60));
      const Stop stop = chip.run_until(until);
      ASSERT_EQ(stop.reason, Stop::Reason::reached) << "seed " << seed << "\n" << stop.report;
      model.run_until(until);
      if (::testing::Test::HasFatalFailure()) return;
      const Registers now = chip.registers();
      ASSERT_EQ(chip.now(), model.now) << "seed " << seed << " slice " << k;
      ASSERT_EQ(now.pc, model.w.pc) << "seed " << seed << " slice " << k;
      ASSERT_EQ(now.er, model.w.er) << "seed " << seed << " slice " << k;
      ASSERT_EQ(now.ccr, model.w.ccr()) << "seed " << seed << " slice " << k;
    }
    for (u32 at = 0xffe080; at < 0xfff000; ++at)
      ASSERT_EQ(chip.peek(at), model.byte(at)) << "seed " << seed << ", " << std::hex << at;
    translated += chip.translated_instructions();
  }
  RecordProperty("translated_instructions", static_cast<int>(translated));
  if (GetParam() == Engine::translator && translator_available()) {
    EXPECT_GT(translated, 100'000);
  }
}

}  // namespace
}  // namespace kaz::h8s::oracle
