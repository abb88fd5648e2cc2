// Every row of the opcode table inside other code, on each engine, against the tests' own model.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <set>

#include "sim/h8s/cpu/opcode.h"
#include "sim/h8s/cpu/oracle_testing.h"

namespace kaz::h8s::oracle {
namespace {

bool has(const Form& form, const char* part) {
  return form.name.find(part) != std::string::npos;
}

std::vector<const Opcode*> rows() {
  std::vector<const Opcode*> all;
  for (const auto group : {move_opcodes(), arithmetic_opcodes(), shift_opcodes(), bit_opcodes(),
                           branch_opcodes(), system_opcodes()}) {
    for (const Opcode& row : group) all.push_back(&row);
  }
  return all;
}

std::string text_of(const Opcode& row) {
  return std::string(row.name).append(" ").append(row.operands);
}

// The bits that every encoding of the row has.
Pin pin_of(const Opcode& row) {
  Pin pin;
  int nibble = 0;
  for (const char* p = row.pattern; *p; ++p) {
    if (*p == ' ') continue;
    u32 mask = 0, value = 0;
    if ((*p >= '0' && *p <= '9') || (*p >= 'A' && *p <= 'F')) {
      mask = 15;
      value = static_cast<u32>(*p <= '9' ? *p - '0' : *p - 'A' + 10);
    } else if (*p == 'm' || *p == 'n' || *p == 't') {
      mask = 8;
    } else if (*p == 'M' || *p == 'N' || *p == 'T') {
      mask = value = 8;
    } else if (*p == 'p') {
      mask = 12;
    }
    const int shift = 12 - 4 * (nibble % 4);
    const auto unit = static_cast<std::size_t>(nibble / 4);
    pin.mask[unit] = static_cast<u16>(pin.mask[unit] | mask << shift);
    pin.value[unit] = static_cast<u16>(pin.value[unit] | value << shift);
    ++nibble;
  }
  return pin;
}

// Instructions around the one under test: they neither jump nor use address registers.
bool tame(const Form& f) {
  if (has(f, "@ER") || has(f, "@(") || has(f, "@@") || f.name == "tas") return false;
  for (const char* name : {"bcc", "bsr", "jmp", "jsr", "rts", "rte", "trapa", "sleep", "eepmov",
                           "stm", "ldm", "daa", "das", "exr", "ldc", "orc", "andc"}) {
    if (has(f, name)) return false;
  }
  return true;
}

bool touches_data(const Form& form) {
  return form.cycles.l + form.cycles.m > 0 && form.name.rfind("eepmov", 0) != 0;
}

// Results that the manual leaves open must not be read by later instructions.
bool leaves_open(const Form& form) {
  return has(form, "daa") || has(form, "das") || has(form, "divx");
}

struct Item {
  const Form* form = nullptr;
  std::vector<u16> units;
};

// A stretch of code with one instruction of the row in it. Small pads, where jumps lead, stand in
// front and behind.
struct Slot {
  u32 entry = 0;
  Item tried;
  u32 tried_at = 0;
  bool io = false;
};

constexpr int kFlashSlots = 20, kRamSlots = 10;
constexpr u32 kFlashSlot = 0x80, kRamSlot = 0x48;
constexpr u32 kRamSlotsAt = 0xffe0c0;
constexpr u16 kStay = 0x40fe;  // bra .

// `whole`: trials that went on to the `bra .` behind the instruction; `entered`: of those, the ones
// in which host code ran; `translated`: trials in which nothing else ran.
struct Tally {
  int trials = 0, whole = 0, entered = 0, translated = 0;
};

class RowBench {
 public:
  RowBench(const Opcode& row, const Options& options, u32 seed)
      : row_(row), bench_(false, options), pin_(pin_of(row)) {
    bench_.random.seed(seed);
    form_ = find(std::vector<u16>(pin_.value.begin(), pin_.value.end()));
    if (!form_) return;
    for (const Form& f : forms()) {
      if (tame(f)) pool_.push_back(&f);
    }
    for (int k = 0; k < kFlashSlots + kRamSlots; ++k) {
      const bool ram = k >= kFlashSlots;
      const u32 at = ram ? kRamSlotsAt + kRamSlot * static_cast<u32>(k - kFlashSlots)
                         : Bench::kFlashCode + kFlashSlot * static_cast<u32>(k);
      build(at, k % 8 == 7);
    }
    // The vectors of TRAPA, and those of JMP and JSR @@aa:8.
    for (u32 vector = 0; vector < 64; ++vector) {
      if (bench_.random() % 4 == 0) continue;
      const u32 to = bench_.landings[bench_.random() % bench_.landings.size()];
      bench_.put(4 * vector, {static_cast<u16>(to >> 16), static_cast<u16>(to)});
    }
  }

  const Form* form() const { return form_; }

  // One trial in the slot; empty when chip and model agree.
  std::string trial(Tally& tally) {
    const Slot& slot = slots_[static_cast<std::size_t>(tally.trials++) % slots_.size()];
    World before = bench_.draw_registers(*slot.tried.form, slot.tried.units, slot.io);
    if (slot.io) bench_.read_io();
    World& w = bench_.world;
    w.er = before.er;
    w.set_ccr(before.ccr());
    w.exr = before.exr;
    w.pc = slot.entry;
    w.asleep = false;
    (void)bench_.outside();
    Chip& chip = bench_.chip;
    chip.set_registers({w.er, w.pc, w.ccr(), w.exr});

    const int states = model(slot);
    const States start = chip.now();
    const std::int64_t executed = chip.instructions(), host = chip.translated_instructions();
    const Stop stop = chip.run_until(start + states);
    const std::int64_t by_host = chip.translated_instructions() - host;
    tally.whole += whole_;
    tally.entered += whole_ && by_host > 0;
    tally.translated += by_host > 0 && by_host == chip.instructions() - executed;

    std::string wrong = bench_.outside();
    if (stop.reason != Stop::Reason::reached) wrong.append(" stopped: ").append(stop.report);
    wrong += bench_.compare(accesses_, open_flags_, open_result_);
    if (chip.now() - start != states)
      wrong +=
          " states are " + std::to_string(chip.now() - start) + " not " + std::to_string(states);
    if (wrong.empty()) return {};
    std::string text = text_of(row_) + " at " + std::to_string(slot.tried_at) + ":";
    for (u32 at = slot.entry; known_.contains(at);) {
      int length = 0;
      text.append("\n  ").append(chip.disassemble(at, &length));
      at += static_cast<u32>(length);
    }
    text.append("\n er");
    for (const u32 er : before.er) text.append(" ").append(std::to_string(er));
    return text.append(" ccr ").append(std::to_string(before.ccr())).append("\n").append(wrong);
  }

  std::string compare_memory() { return bench_.compare_memory(); }

 private:
  void append(u32& at, const Item& item) {
    known_[at] = item;
    bench_.put(at, item.units);
    at += 2 * static_cast<u32>(item.units.size());
  }

  Item item(std::vector<u16> units) { return {find(units), std::move(units)}; }

  void pad(u32& at) {
    bench_.landings.push_back(at);
    for (int k = 0; k < 3; ++k) append(at, item({0x0000}));
    append(at, item({kStay}));
  }

  // A tame instruction that leaves the registers `busy` alone.
  Item filler(const std::set<u32>& busy) {
    for (;;) {
      const Form& form = *pool_[bench_.random() % pool_.size()];
      const std::vector<u16> units = bench_.draw_units(form, false);
      const Fields f = form.fields(units);
      if (busy.contains(f['d'] % 8) || f['d'] % 8 == 7) continue;
      return {&form, units};
    }
  }

  // Registers that lead the tried instruction to memory.
  std::set<u32> pointers(const Item& tried) const {
    const Fields f = tried.form->fields(tried.units);
    if (has(*tried.form, "eepmov")) return {4, 5, 6, 7};
    std::set<u32> busy{7, f['r']};
    if (has(*tried.form, "@ERd")) busy.insert(f['d']);
    return busy;
  }

  // Bcc and BSR: mostly to a pad.
  void aim_branch(std::vector<u16>& units, u32 at, u32 front, u32 back) {
    const bool near = form_->name.find("d:8") != std::string::npos;
    const bool far = form_->name.find("d:16") != std::string::npos && !has(*form_, "@");
    if ((!near && !far) || has(*form_, "@") || bench_.random() % 4 == 0) return;
    const u32 next = at + 2 * static_cast<u32>(units.size());
    const u32 to = (bench_.random() % 2 ? front : back) - next;
    if (near)
      units[0] = static_cast<u16>((units[0] & 0xff00) | (to & 0xff));
    else
      units[1] = static_cast<u16>(to);
  }

  void build(u32 at, bool io) {
    Slot slot;
    slot.io = io && touches_data(*form_);
    const u32 front = at;
    pad(at);
    slot.entry = at;
    append(at, item({0x0000}));
    Decoded decoded;
    do {
      slot.tried = {form_, bench_.draw_units(*form_, slot.io, pin_)};
      decoded = decode(slot.tried.units, false);
    } while (decoded.opcode != &row_ && ++redrawn_ < 1000);
    const std::set<u32> busy = pointers(slot.tried);
    for (u32 n = bench_.random() % 3; n-- > 0;) append(at, filler(busy));
    std::vector<Item> behind;
    u32 length = 2 * static_cast<u32>(slot.tried.units.size()) + 2;
    if (!leaves_open(*form_)) {
      for (u32 n = bench_.random() % 3; n-- > 0;) behind.push_back(filler({}));
    }
    for (const Item& i : behind) length += 2 * static_cast<u32>(i.units.size());
    slot.tried_at = at;
    aim_branch(slot.tried.units, at, front, at + length);
    append(at, slot.tried);
    for (const Item& i : behind) append(at, i);
    append(at, item({kStay}));
    pad(at);
    slots_.push_back(slot);
  }

  // Runs the model from the slot's entry to `bra .`, or until it leaves the code that is known;
  // the states that takes.
  int model(const Slot& slot) {
    World& w = bench_.world;
    accesses_.clear();
    open_flags_ = 0;
    open_result_ = whole_ = false;
    int states = 0;
    for (int k = 0; k < 40 && known_.contains(w.pc) && !w.asleep; ++k) {
      const u32 at = w.pc;
      const Item& next = known_[at];
      states += step(w, *next.form, next.units);
      for (const Access& a : w.data) states += bench_.io_states(a);
      accesses_.insert(accesses_.end(), w.data.begin(), w.data.end());
      if (at == slot.tried_at) {
        open_flags_ = w.open_flags;
        open_result_ = w.open_result;
      }
      whole_ = next.units[0] == kStay;
      if (whole_) break;
    }
    return states;
  }

  const Opcode& row_;
  Bench bench_;
  Pin pin_;
  const Form* form_ = nullptr;
  std::vector<const Form*> pool_;
  std::map<u32, Item> known_;
  std::vector<Slot> slots_;
  std::vector<Access> accesses_;
  u8 open_flags_ = 0;
  bool open_result_ = false, whole_ = false;
  int redrawn_ = 0;
};

constexpr int kTrials = 1000;  // of one set of encodings

// Sets of encodings a row, for at least KAZ_FORM_TRIALS trials.
u32 rounds() {
  const char* text = std::getenv("KAZ_FORM_TRIALS");
  return text ? static_cast<u32>(std::max(1, (std::atoi(text) + kTrials - 1) / kTrials)) : 1;
}

class EveryRow : public ::testing::TestWithParam<Engine> {
 protected:
  static Options options() {
    Options o;
    o.engine = GetParam();
    o.translate_after = 1;
    return o;
  }
  static bool translates() { return GetParam() == Engine::translator && translator_available(); }

  // The form of the model that was tried; null where something failed, which is reported.
  const Form* run(const Opcode& row, const Options& options, u32 seed) {
    RowBench bench(row, options, seed);
    if (!bench.form()) {
      ADD_FAILURE() << "the model has no " << text_of(row);
      return nullptr;
    }
    Tally tally;
    while (tally.trials < kTrials) {
      const std::string text = bench.trial(tally);
      if (text.empty()) continue;
      ADD_FAILURE() << text;
      return nullptr;
    }
    trials += tally.trials;
    const std::string memory = bench.compare_memory();
    EXPECT_TRUE(memory.empty()) << "after " << text_of(row) << ": " << memory;
    if (!translates()) return bench.form();
    // A run that ends at the instruction, because that leads elsewhere or sleeps, is shorter than the
    // block, which is then not entered; nor is it where a branch takes the shorter way. A slot's first
    // run translates it.
    const bool branches = std::string(row.operands) == "%j";
    EXPECT_GE(tally.entered, branches ? tally.whole / 2 : tally.whole - (kFlashSlots + kRamSlots))
        << text_of(row) << ": the code around it";
    EXPECT_TRUE(tally.whole > kTrials / 4 || text_of(row) == "sleep ") << text_of(row);
    EXPECT_GT(tally.translated, kTrials / 2) << text_of(row);
    return bench.form();
  }

  std::int64_t trials = 0;
};

std::string engine_name(const ::testing::TestParamInfo<Engine>& engine) {
  return name_of(engine.param);
}
INSTANTIATE_TEST_SUITE_P(Engines, EveryRow,
                         ::testing::Values(Engine::reference, Engine::interpreter,
                                           Engine::translator),
                         engine_name);

TEST_P(EveryRow, OfTheOpcodeTableDoesWhatTheManualSays) {
  std::set<const Form*> reached;
  int wrong = 0;
  for (const Opcode* row : rows()) {
    for (u32 round = 0; round < rounds(); ++round) {
      const Form* form = run(*row, options(), 12345 + round);
      reached.insert(form);
      if (form) continue;
      if (++wrong > 20) return;
      break;
    }
  }
  EXPECT_EQ(reached.size(), forms().size()) << "forms of the model without a row";
  EXPECT_EQ(trials, static_cast<std::int64_t>(rows().size()) * rounds() * kTrials);
}

// The other setting of Options::predecrement_stores_decremented.
TEST_P(EveryRow, ThatDecrementsStoresTheOldRegisterIfRequested) {
  Options other = options();
  other.predecrement_stores_decremented = false;
  int tried = 0;
  for (const Opcode* row : rows()) {
    if (std::string(row->operands).find("@-%") == std::string::npos) continue;
    ++tried;
    for (u32 round = 0; round < 3 * rounds(); ++round) run(*row, other, 54321 + round);
  }
  EXPECT_EQ(tried, 5);  // MOV.B, W, L; STC of CCR, EXR
}

TEST(NormalMode, IsLeftToTheInterpreter) {
  Options options;
  options.engine = Engine::translator;
  options.translate_after = 1;
  Bench bench(true, options);
  EXPECT_EQ(bench.chip.engine(), Engine::interpreter);
  bench.put(0xffe200, {0x0b50, 0x40fc});  // inc.w #1,r0 ; bra back
  Registers r = bench.chip.registers();
  r.pc = 0xe200;
  bench.chip.set_registers(r);
  EXPECT_EQ(bench.chip.run_until(bench.chip.now() + 3000).reason, Stop::Reason::reached);
  EXPECT_GT(bench.chip.instructions(), 1900);
  EXPECT_EQ(bench.chip.translated_instructions(), 0);
}

}  // namespace
}  // namespace kaz::h8s::oracle
