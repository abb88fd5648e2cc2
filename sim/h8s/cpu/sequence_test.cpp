// Random loops of instructions: each engine against the tests' own model, boundary by boundary.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "sim/h8s/chip/chip_testing.h"
#include "sim/h8s/cpu/oracle_testing.h"

namespace kaz::h8s::oracle {
namespace {

constexpr u32 kStart = testing::kCode;
constexpr u32 kBase = 0xffe000;

bool has(const Form& form, const char* part) {
  return form.name.find(part) != std::string::npos;
}

// Instructions that stay inside the loop whatever the registers hold.
bool tame(const Form& f) {
  if (has(f, "@ER") || has(f, "@(") || has(f, "@@") || f.name == "tas") return false;
  for (const char* name : {"bcc", "bsr", "jmp", "jsr", "rts", "rte", "trapa", "sleep", "eepmov",
                           "stm", "ldm", "daa", "das", "exr"}) {
    if (has(f, name)) return false;
  }
  return true;
}

class Maker {
 public:
  explicit Maker(u32 seed) : random_(seed) {
    for (const Form& f : forms()) {
      if (tame(f)) pool_.push_back(&f);
      if (f.name == "bcc d:8") branch_ = &f;
    }
  }

  // A loop of about `count` instructions with branches over some of them, pushes and pops.
  std::vector<u16> loop(int count) {
    std::vector<u16> words;
    for (int k = 0; k < count; ++k) {
      if (random_() % 6 == 0) {
        std::vector<u16> skipped;
        for (u32 n = random_() % 3; n-- > 0;) append(skipped, one());
        Fields f;
        f.value['c' - 'a'] = random_() % 16;
        f.value['o' - 'a'] = static_cast<u32>(2 * skipped.size());
        append(words, encode(*branch_, f));
        append(words, skipped);
      } else if (random_() % 10 == 0) {
        const u32 from = random_() % 7, to = random_() % 7;
        append(words, {0x0100, static_cast<u16>(0x6df0 | from)});  // push.l
        append(words, one());
        append(words, {0x0100, static_cast<u16>(0x6d70 | to)});  // pop.l
      } else {
        append(words, one());
      }
    }
    const auto back = static_cast<u16>(-2 * static_cast<int>(words.size()) - 4);
    append(words, {0x5800, back});  // bra
    return words;
  }

  u32 number() { return static_cast<u32>(random_()); }

 private:
  static void append(std::vector<u16>& to, const std::vector<u16>& from) {
    to.insert(to.end(), from.begin(), from.end());
  }

  std::vector<u16> one() {
    const Form& form = *pool_[random_() % pool_.size()];
    Fields f;
    for (u32 n = 0; n < 26; ++n) f.value[n] = number();
    // Not the stack pointer.
    for (const char ch : {'d', 's', 'n', 'r'}) {
      u32& field = f.value[static_cast<std::size_t>(ch - 'a')];
      field %= form.bits.find(std::string(4, ch)) == std::string::npos ? 8 : 16;
      if (field % 8 == 7) --field;
    }
    u32& address = f.value['a' - 'a'];
    address = 0xffe400 + address % 0x100 * 2;
    if (has(form, "@aa:8")) address = number() % 0x78;
    return encode(form, f);
  }

  std::mt19937 random_;
  std::vector<const Form*> pool_;
  const Form* branch_ = nullptr;
};

// The model with the chip's memory map, as far as these loops go.
class Model {
 public:
  explicit Model(const std::vector<u16>& words) : ram_(0x2000, 0) {
    for (std::size_t k = 0; k + 4 < words.size() + 5; ++k) {
      std::array<u16, 5> units{};
      for (std::size_t n = 0; n < 5 && k + n < words.size(); ++n) units[n] = words[k + n];
      units_.push_back(units);
      found_.push_back(k < words.size() ? find(units) : nullptr);
    }
    w.read = [this](u32 a) { return ram_[(a - kBase) & 0x1fff]; };
    w.write = [this](u32 a, u8 v) { ram_[(a - kBase) & 0x1fff] = v; };
  }

  void run_until(States until) {
    while (now < until) {
      const std::size_t k = (w.pc - kStart) / 2;
      ASSERT_LT(k, found_.size());
      ASSERT_NE(found_[k], nullptr);
      now += step(w, *found_[k], units_[k]);
    }
  }
  u8 byte(u32 address) const { return ram_[address - kBase]; }

  World w;
  States now = 0;

 private:
  std::vector<u8> ram_;
  std::vector<std::array<u16, 5>> units_;
  std::vector<const Form*> found_;
};

class Sequence : public ::testing::TestWithParam<Engine> {};

std::string name_of(const ::testing::TestParamInfo<Engine>& engine) {
  return engine.param == Engine::reference     ? "reference"
         : engine.param == Engine::interpreter ? "interpreter"
                                               : "translator";
}
INSTANTIATE_TEST_SUITE_P(Engines, Sequence,
                         ::testing::Values(Engine::reference, Engine::interpreter,
                                           Engine::translator),
                         name_of);

TEST_P(Sequence, LoopsEndWhereTheModelSays) {
  for (u32 seed = 1; seed <= 40; ++seed) {
    Maker maker(seed);
    const std::vector<u16> words = maker.loop(10 + static_cast<int>(seed));
    Options options;
    options.engine = GetParam();
    Chip chip = testing::make_chip(words, options);
    Model model(words);
    for (u32 at = 0xffe080; at < 0xfff000; ++at) chip.poke(at, 0);
    for (u32 at = 0xffff00; at < 0xffff80; ++at) chip.poke(at, 0);
    Registers r = chip.registers();
    for (u32 n = 0; n < 7; ++n) r.er[n] = maker.number();
    chip.set_registers(r);
    model.w.er = r.er;
    model.w.pc = r.pc;
    model.w.set_ccr(r.ccr);
    // Boundaries of all distances: the engines must stop exactly there.
    for (int k = 0; k < 120; ++k) {
      const States until =
          chip.now() + static_cast<States>(maker.number() % (k % 8 == 0 ? 3000 : 97));
      const Stop stop = chip.run_until(until);
      ASSERT_EQ(stop.reason, Stop::Reason::reached) << stop.report;
      model.run_until(until);
      const Registers now = chip.registers();
      ASSERT_EQ(chip.now(), model.now) << "seed " << seed << " step " << k;
      ASSERT_EQ(now.pc, model.w.pc) << "seed " << seed << " step " << k;
      ASSERT_EQ(now.er, model.w.er) << "seed " << seed << " step " << k;
      ASSERT_EQ(now.ccr, model.w.ccr()) << "seed " << seed << " step " << k;
    }
    for (u32 at = 0xffe080; at < 0xfff000; ++at)
      ASSERT_EQ(chip.peek(at), model.byte(at)) << "seed " << seed << ", " << std::hex << at;
  }
}

}  // namespace
}  // namespace kaz::h8s::oracle
