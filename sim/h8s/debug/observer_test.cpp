// Observed runs equal unobserved ones, and reports to observers match the execution.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/observer.h"

#include "sim/h8s/debug/debug_testing.h"

namespace kaz::h8s::testing {
namespace {

struct Everything : Observer {
  std::vector<Executed> steps;
  std::vector<Access> accesses;
  std::vector<ExceptionEntry> entries;
  States slept_states = 0;
  void executed(const Executed& e) override { steps.push_back(e); }
  void accessed(const Access& a) override { accesses.push_back(a); }
  void entered(const ExceptionEntry& e) override { entries.push_back(e); }
  void slept(States from, States to) override { slept_states += to - from; }
};

TEST(Observed, RunEqualsUnobservedRun) {
  for (const Engine engine : {Engine::reference, Engine::interpreter, Engine::translator}) {
    Options options;
    options.engine = engine;
    Chip plain = busy_chip(options), seen = busy_chip(options);
    Everything observer;
    plain.run_until(40'000);
    seen.run_until(7'000);
    seen.attach(observer);
    seen.run_until(30'000);
    seen.detach(observer);
    seen.run_until(40'000);
    expect_same(plain, seen);
    EXPECT_GT(observer.entries.size(), 100u);
  }
}

TEST(Observed, InstructionsFollowEachOtherWithoutAGap) {
  Chip chip = busy_chip();
  Everything observer;
  chip.attach(observer);
  chip.run_until(20'000);
  std::size_t next_entry = 0;
  States at = 0;
  std::uint32_t pc = kCode;
  for (const Executed& e : observer.steps) {
    while (next_entry < observer.entries.size() && observer.entries[next_entry].begin == at) {
      const ExceptionEntry& entry = observer.entries[next_entry++];
      EXPECT_EQ(entry.interrupted, pc);
      EXPECT_EQ(entry.end - entry.begin, 8);
      at = entry.end;
      pc = entry.handler;
    }
    ASSERT_EQ(e.begin, at);
    ASSERT_EQ(e.pc, pc);
    at = e.end;
    pc = e.next;
  }
  EXPECT_EQ(at, chip.now());
  EXPECT_EQ(pc, chip.registers().pc);
  EXPECT_EQ(static_cast<std::int64_t>(observer.steps.size()), chip.instructions());
}

TEST(Observed, AccessesWithAddressValueAndInstruction) {
  Program p;
  p.words({0x7a00, 0x1234, 0x5678});         // mov.l #0x12345678,er0
  p.words({0x0100, 0x6b80, 0xe100});         // mov.l er0,@0xffe100:16
  p.words({0x6a0a, 0xe101});                 // mov.b @0xffe101:16,r2l
  p.words({0x5500, 0x6b01, 0x0000}).stay();  // bsr .+2 ; mov.w @0:16,r1 ; bra .
  Chip chip = make_chip(p);
  Everything observer;
  chip.attach(observer);
  chip.run_until(40);
  ASSERT_EQ(observer.accesses.size(), 6u);
  const auto expect = [&](std::size_t k, std::uint32_t address, unsigned value, int size,
                          bool write, std::uint32_t pc) {
    const Access& a = observer.accesses[k];
    EXPECT_EQ(a.address, address) << k;
    EXPECT_EQ(a.value, value) << k;
    EXPECT_EQ(a.size, size) << k;
    EXPECT_EQ(a.write, write) << k;
    EXPECT_EQ(a.pc, pc) << k;
  };
  expect(0, 0xffe100, 0x1234, 2, true, kCode + 6);
  expect(1, 0xffe102, 0x5678, 2, true, kCode + 6);
  expect(2, 0xffe101, 0x34, 1, false, kCode + 12);
  expect(3, kStack - 4, 0, 2, true, kCode + 16);
  expect(4, kStack - 2, kCode + 18, 2, true, kCode + 16);
  expect(5, 0x000000, 0, 2, false, kCode + 18);
  EXPECT_EQ(observer.steps[3].flow, Flow::call);
}

TEST(Observed, SleepAndRequestToStop) {
  Program p;
  p.out8(0xffffc2, 0x01).enable_interrupts().word(0x0180).stay();  // IER, SLEEP
  Chip chip = make_chip(p);
  struct Stopper : Everything {
    Chip* chip = nullptr;
    void accessed(const Access& a) override {
      if (a.write) chip->request_stop();
    }
  } observer;
  observer.chip = &chip;
  chip.attach(observer);
  EXPECT_EQ(chip.run_until(1000).reason, Stop::Reason::requested);
  EXPECT_EQ(chip.registers().pc, kCode + 6);
  chip.run_until(1000);
  EXPECT_EQ(observer.slept_states + observer.steps.back().end, 1000);
}

TEST(Hooks, StopOnABlockMoveOnceAndItMovesEverything) {
  Program p;
  p.words({0x7a05, 0x0000, 0x0000, 0x7a06, 0x00ff, 0xe100, 0x7904, 0x0100});
  const std::uint32_t at = end_of(p);
  p.words({0x7bd4, 0x598f}).stay();
  Chip plain = make_chip(p), stopped = make_chip(p);
  plain.run_until(2000);
  stopped.set_breakpoint(at);
  EXPECT_EQ(stopped.run_until(2000).reason, Stop::Reason::breakpoint);
  EXPECT_EQ(stopped.run_until(100).reason, Stop::Reason::reached);
  EXPECT_EQ(stopped.run_until(2000).reason, Stop::Reason::reached);
  expect_same(plain, stopped);
}

}  // namespace
}  // namespace kaz::h8s::testing
