// The suite for bus servos at virtual ones: all models pass, altered ones fail, all is put back.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "hil/bus/bus_suite.h"
#include "host/link/interruptible.h"
#include "sim/bus/bus_testing.h"
#include "tests/integration/servo_conformance/bus_link_testing.h"

namespace kaz::test {
namespace {

using hil::ServoFamily;
using hil::Verdict;
using Bytes = std::vector<std::uint8_t>;

constexpr int kId = 1;

ServoFamily family_of(const std::string& model) {
  return servo_bus::find_model(model)->protocol == servo_bus::Protocol::feetech
             ? ServoFamily::feetech
             : ServoFamily::dynamixel;
}

// The bytes of all registers that a host writes, but for goals.
std::map<std::string, int> memory_of(sim::VirtualBus& bus) {
  std::map<std::string, int> all;
  const auto& registers = bus.servo(0).registers();
  for (const auto& reg : registers.model().registers) {
    if (!reg.writable || reg.name.starts_with("goal_")) continue;
    for (int i = 0; i < reg.count; ++i)
      all[std::string(reg.name) + std::to_string(i)] = registers.get(reg, i);
  }
  return all;
}

std::set<std::string> failed_of(const hil::RunReport& report) {
  std::set<std::string> all;
  for (const auto& one : report.results)
    if (one.verdict == Verdict::failed) all.insert(one.of->id);
  return all;
}

std::string messages_of(const hil::RunReport& report) {
  std::string text;
  for (const auto& one : report.results)
    if (one.verdict == Verdict::failed) text += one.of->id + ": " + one.message + "\n";
  return text;
}

constexpr unsigned kAll = hil::kServoMotion | hil::kServoEeprom | hil::kServoAlone;

class Models : public testing::TestWithParam<std::string> {};

TEST_P(Models, PassesWithoutMovingAndIsAsItWas) {
  const auto bus = sim::test::bus_of({kId, 2}, GetParam());
  bus->advance(std::chrono::milliseconds(3));
  BusLink link(*bus);
  const auto before = memory_of(*bus);
  const double angle = bus->world().joints()[0].angle;
  hil::BusRunOptions options;
  options.family = family_of(GetParam());
  const auto report = hil::run_bus_suite(link, link, options);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(messages_of(*report), "");
  EXPECT_EQ(memory_of(*bus), before);
  EXPECT_EQ(bus->world().joints()[0].angle, angle);
  EXPECT_GT(report->count(Verdict::passed), 12);
  EXPECT_NE(report->board.find(GetParam()), std::string::npos) << report->board;
  for (const auto& one : report->results) {
    if (one.verdict == Verdict::left_out) {
      EXPECT_FALSE(one.message.empty());
    }
  }
}

TEST_P(Models, PassesEveryCaseAndIsAsItWas) {
  const auto bus = sim::test::bus_of({kId}, GetParam());
  bus->advance(std::chrono::milliseconds(3));
  BusLink link(*bus);
  const auto before = memory_of(*bus);
  hil::BusRunOptions options;
  options.family = family_of(GetParam());
  options.allowed = kAll;
  const auto report = hil::run_bus_suite(link, link, options);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(messages_of(*report), "");
  EXPECT_EQ(memory_of(*bus), before);
  for (const auto& one : report->results) {
    if (one.verdict == Verdict::left_out) {
      EXPECT_TRUE(one.message.find("cannot be undone") != std::string::npos ||
                  one.message.find("model") != std::string::npos)
          << one.of->id << one.message;
    }
  }
}

TEST(ServoTorque, IsSwitchedOffUntilItIsReadBack) {
  const auto bus = sim::test::bus_of({kId}, "sts3215");
  bus->advance(std::chrono::milliseconds(3));
  BusLink link(*bus);
  const auto before = memory_of(*bus);
  hil::BusRunOptions options;
  options.family = ServoFamily::feetech;
  options.allowed = kAll;
  options.filter = "^motion.goal$";
  // The answers to it, and to what is read then, come damaged.
  int damaged = 0;
  link.request = [&, first = true](Bytes wire) mutable {
    if (switches_off(wire) && std::exchange(first, false)) damaged = 3;
    return wire;
  };
  link.answer = [&](Bytes wire) {
    if (damaged > 0 && damaged-- > 0) wire.back() ^= 0x10;
    return wire;
  };
  const auto report = hil::run_bus_suite(link, link, options);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(messages_of(*report), "");
  EXPECT_EQ(memory_of(*bus), before);
  EXPECT_EQ(bus->servo(0).registers().get("torque_enable"), 0);

  // One that it has before is tried again, too.
  link.answer = nullptr;
  link.request = nullptr;
  ASSERT_TRUE(link.write(hil::servo_request(ServoFamily::feetech, kId, 3, {40, 1})));
  ASSERT_TRUE(link.sleep_until(link.now() + std::chrono::milliseconds(20)));
  ASSERT_EQ(bus->servo(0).registers().get("torque_enable"), 1);
  int lost = 0;
  link.request = [&](Bytes wire) {
    return switches_off(wire) && lost++ < 2 ? Bytes() : std::move(wire);
  };
  options.release = true;
  options.filter = "^packet.ping$";
  const auto released = hil::run_bus_suite(link, link, options);
  EXPECT_TRUE(released) << released.error().message;
  EXPECT_EQ(bus->servo(0).registers().get("torque_enable"), 0);

  // A servo that keeps it is named.
  link.request = [](Bytes wire) { return switches_off(wire) ? Bytes() : wire; };
  options.filter = "^motion.goal$";
  const auto kept = hil::run_bus_suite(link, link, options);
  ASSERT_TRUE(kept);
  EXPECT_NE(messages_of(*kept).find("its torque is not confirmed to be off: cut its power"),
            std::string::npos)
      << messages_of(*kept);
}

INSTANTIATE_TEST_SUITE_P(All, Models,
                         testing::Values("sts3215", "scs0009", "xl330-m288", "xl330-m077",
                                         "xl430-w250", "xm430-w350"),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

struct Mutant {
  const char* name;
  const char* model;
  const char* judge;  // a case that has to fail
  std::function<void(BusLink&, sim::VirtualBus&)> alter;
};

// Whether `wire` is a request of this instruction.
bool is(const Bytes& wire, ServoFamily family, int instruction) {
  const std::size_t at = family == ServoFamily::feetech ? 4 : 7;
  return wire.size() > at && wire[at] == instruction;
}

Bytes with_instruction(const Bytes& wire, ServoFamily family, int instruction) {
  const bool feetech = family == ServoFamily::feetech;
  const std::size_t at = feetech ? 4 : 7;
  return hil::servo_request(
      family, wire[feetech ? 2 : 4], instruction,
      Bytes(wire.begin() + static_cast<std::ptrdiff_t>(at) + 1, wire.end() - (feetech ? 1 : 2)));
}

// A servo that does not check: requests arrive with the checksum that they should have.
Bytes repaired(const Bytes& wire, ServoFamily family) {
  const std::size_t at = family == ServoFamily::feetech ? 4 : 7;
  return wire.size() <= at + 1 ? wire : with_instruction(wire, family, wire[at]);
}

void instead(BusLink& link, ServoFamily family, int of, int executed) {
  link.request = [=](Bytes wire) {
    return is(wire, family, of) ? with_instruction(wire, family, executed) : wire;
  };
}

void ignored(BusLink& link, ServoFamily family, int instruction) {
  link.request = [=](Bytes wire) { return is(wire, family, instruction) ? Bytes{} : wire; };
}

constexpr auto kFeetech = ServoFamily::feetech, kDynamixel = ServoFamily::dynamixel;

const Mutant kMutants[] = {
    {"does_not_check", "sts3215", "packet.checksum",
     [](BusLink& link, sim::VirtualBus&) {
       link.request = [](Bytes wire) { return repaired(wire, kFeetech); };
     }},
    {"does_not_check", "xl330-m288", "packet.crc",
     [](BusLink& link, sim::VirtualBus&) {
       link.request = [](Bytes wire) { return repaired(wire, kDynamixel); };
     }},
    {"executes_reg_writes_at_once", "sts3215", "instructions.reg-write",
     [](BusLink& link, sim::VirtualBus&) { instead(link, kFeetech, 4, 3); }},
    {"executes_reg_writes_at_once", "scs0009", "instructions.reg-write",
     [](BusLink& link, sim::VirtualBus&) { instead(link, kFeetech, 4, 3); }},
    {"executes_reg_writes_at_once", "xl330-m288", "instructions.reg-write",
     [](BusLink& link, sim::VirtualBus&) { instead(link, kDynamixel, 4, 3); }},
    {"has_no_sync_write", "sts3215", "instructions.sync-write",
     [](BusLink& link, sim::VirtualBus&) { ignored(link, kFeetech, 0x83); }},
    {"has_no_sync_read", "sts3215", "instructions.sync-read",
     [](BusLink& link, sim::VirtualBus&) { ignored(link, kFeetech, 0x82); }},
    {"has_no_bulk_write", "xl330-m288", "groups.bulk-write",
     [](BusLink& link, sim::VirtualBus&) { ignored(link, kDynamixel, 0x93); }},
    {"has_no_fast_read", "xm430-w350", "groups.fast-sync-read",
     [](BusLink& link, sim::VirtualBus&) { ignored(link, kDynamixel, 0x8A); }},
    {"answers_sync_reads_of_others", "xl330-m288", "groups.sync-read-of-others",
     [](BusLink& link, sim::VirtualBus&) {
       link.request = [](Bytes wire) {
         if (!is(wire, kDynamixel, 0x82)) return wire;
         Bytes parameters(wire.begin() + 8, wire.end() - 2);
         parameters.back() = kId;
         return hil::servo_request(kDynamixel, 254, 0x82, parameters);
       };
     }},
    {"answers_to_every_id", "sts3215", "packet.other-id",
     [](BusLink& link, sim::VirtualBus&) {
       link.request = [](Bytes wire) {
         const bool other = wire.size() == 6 && wire[4] == 1 && wire[2] > 200;
         return other ? hil::servo_request(kFeetech, kId, 1) : wire;
       };
     }},
    {"writes_read_only_registers", "sts3215", "registers.ram-read-only",
     [](BusLink& link, sim::VirtualBus&) {
       // As if 0 had been written: from then on 0 is read.
       link.request = [written = false](Bytes wire) mutable {
         if (is(wire, kFeetech, 3) && wire[5] == 62) written = true;
         if (written && is(wire, kFeetech, 2) && wire[5] == 62)
           return hil::servo_request(kFeetech, 1, 2, {64, 1});
         return wire;
       };
     }},
    {"shifts_the_table", "sts3215", "registers.readable",
     [](BusLink& link, sim::VirtualBus&) {
       link.request = [](Bytes wire) {
         if (is(wire, kFeetech, 2) && wire[5] == 48)
           return hil::servo_request(kFeetech, 1, 2, {48, 1});
         return wire;
       };
     }},
    {"limits_a_register_otherwise", "sts3215", "registers.ram",
     [](BusLink& link, sim::VirtualBus&) {
       link.request = [](Bytes wire) {
         if (is(wire, kFeetech, 3) && wire[5] == 41 && wire[6] == 254)
           return hil::servo_request(kFeetech, 1, 3, {41, 253});
         return wire;
       };
     }},
    {"holds_what_it_may_not", "sts3215", "registers.in-range",
     [](BusLink& link, sim::VirtualBus&) {
       // A dead zone of 80, as another tool may have left it: that of another register is read.
       link.request = [](Bytes wire) {
         if (is(wire, kFeetech, 2) && wire[5] == 26)
           return hil::servo_request(kFeetech, kId, 2, {36, 1});
         return wire;
       };
     }},
    {"keeps_no_values", "xl330-m288", "registers.ram",
     [](BusLink& link, sim::VirtualBus&) {
       link.request = [](Bytes wire) {
         // Position P Gain
         if (is(wire, kDynamixel, 3) && wire[8] == 84)
           return hil::servo_request(kDynamixel, 1, 3, {82, 0, 0, 0});
         return wire;
       };
     }},
    {"has_no_ranges", "xl330-m288", "errors.range",
     [](BusLink& link, sim::VirtualBus&) {
       link.answer = [](Bytes wire) {
         if (wire.size() == 11 && wire[8] == 4) wire = hil::servo_request(kDynamixel, 1, 0x55, {0});
         return wire;
       };
     }},
    {"counts_stuffing_as_data", "xl330-m288", "packet.stuffing",
     [](BusLink& link, sim::VirtualBus&) {
       link.request = [](Bytes wire) {
         if (is(wire, kDynamixel, 3) && wire.size() > 14 && wire[10] == 0xFF && wire[11] == 0xFF)
           return hil::servo_request(kDynamixel, 1, 3, {112, 0, 1, 0, 0, 0, 5});
         return wire;
       };
     }},
    {"answers_late_or_never", "sts3215", "packet.all-answered",
     [](BusLink& link, sim::VirtualBus&) {
       link.request = [n = 0](Bytes wire) mutable { return ++n % 70 == 69 ? Bytes{} : wire; };
     }},
    {"damages_answers", "xl330-m288", "packet.all-answered",
     [](BusLink& link, sim::VirtualBus&) {
       link.answer = [n = 0](Bytes wire) mutable {
         if (++n % 50 == 49) wire.back() ^= 1;
         return wire;
       };
     }},
    {"does_not_go_to_goals", "sts3215", "motion.goal",
     [](BusLink& link, sim::VirtualBus&) {
       link.request = [](Bytes wire) {
         if (is(wire, kFeetech, 3) && wire[5] == 42)
           return hil::servo_request(kFeetech, 1, 3, {41, 0});
         return wire;
       };
     }},
    {"writes_eeprom_with_the_torque_on", "xl330-m288", "motion.eeprom-is-locked",
     [](BusLink& link, sim::VirtualBus&) {
       link.answer = [](Bytes wire) {
         if (wire.size() == 11 && wire[8] == 7) wire = hil::servo_request(kDynamixel, 1, 0x55, {0});
         return wire;
       };
     }},
};

class Altered : public testing::TestWithParam<Mutant> {};

TEST_P(Altered, FailsTheCaseThatSaysSo) {
  const Mutant& mutant = GetParam();
  const auto bus = sim::test::bus_of({kId}, mutant.model);
  bus->advance(std::chrono::milliseconds(3));
  BusLink link(*bus);
  mutant.alter(link, *bus);
  hil::BusRunOptions options;
  options.family = family_of(mutant.model);
  options.allowed = kAll;
  const auto report = hil::run_bus_suite(link, link, options);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_TRUE(failed_of(*report).contains(mutant.judge)) << messages_of(*report);
  EXPECT_EQ(bus->servo(0).registers().get("torque_enable"), 0);
}

INSTANTIATE_TEST_SUITE_P(All, Altered, testing::ValuesIn(kMutants), [](const auto& test) {
  std::string name = std::string(test.param.name) + "_" + test.param.model;
  std::ranges::replace(name, '-', '_');
  return name;
});

TEST(ServoSuite, RefusesAServoThatHoldsUnlessItMayRelease) {
  const auto bus = sim::test::bus_of({kId});
  bus->advance(std::chrono::milliseconds(3));
  BusLink link(*bus);
  sim::test::BusHost host(*bus);
  ASSERT_TRUE(host.set(kId, "torque_enable", 1));
  hil::BusRunOptions options;
  options.filter = "packet.ping";
  auto report = hil::run_bus_suite(link, link, options);
  ASSERT_FALSE(report);
  EXPECT_NE(report.error().message.find("has its torque on"), std::string::npos);
  EXPECT_EQ(bus->servo(0).registers().get("torque_enable"), 1);
  options.release = true;
  report = hil::run_bus_suite(link, link, options);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(bus->servo(0).registers().get("torque_enable"), 0);
}

TEST(ServoSuite, NobodyAndStrangersAreNamed) {
  const auto bus = sim::test::bus_of({3});
  BusLink link(*bus);
  hil::BusRunOptions options;
  auto report = hil::run_bus_suite(link, link, options);
  ASSERT_FALSE(report);
  EXPECT_NE(report.error().message.find("does not answer"), std::string::npos);
  options.id = 3;
  link.request = [](Bytes wire) {  // the limits in place of the model's number
    return is(wire, kFeetech, 2) && wire[5] == 3 ? hil::servo_request(kFeetech, 3, 2, {11, 2})
                                                 : wire;
  };
  report = hil::run_bus_suite(link, link, options);
  ASSERT_FALSE(report);
  EXPECT_NE(report.error().message.find("model number 4095"), std::string::npos)
      << report.error().message;
}

// A level that reads 0 is judged by one write: an emulator may not have the register.
TEST(ServoSuite, OneWriteDecidesAtLevelZero) {
  const auto bus = sim::test::bus_of({kId});
  bus->advance(std::chrono::milliseconds(3));
  BusLink link(*bus);
  hil::BusRunOptions options;
  options.filter = "packet.ping";
  int writes = 0;
  link.request = [&](Bytes wire) {
    if (is(wire, kFeetech, 3)) ++writes;
    // The order of bytes, which is 0, in place of the level.
    return is(wire, kFeetech, 2) && wire[5] == 8 ? hil::servo_request(kFeetech, kId, 2, {2, 1})
                                                 : wire;
  };
  const auto report = hil::run_bus_suite(link, link, options);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(messages_of(*report), "");
  EXPECT_EQ(writes, 1);
  bus->servo(0).registers().set("response_level", 0);
  const auto refused = hil::run_bus_suite(link, link, options);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("answers only reads"), std::string::npos);
}

// Interrupted in the middle of each case: what it had changed is put back.
TEST(ServoSuite, AnInterruptedRunLeavesTheServoAsItWas) {
  for (const char* model : {"sts3215", "xl330-m288"}) {
    for (int at = 40; at < 1500; at += 97) {
      const auto bus = sim::test::bus_of({kId}, model);
      bus->advance(std::chrono::milliseconds(3));
      BusLink link(*bus);
      const auto before = memory_of(*bus);
      host::Interrupt interrupt;
      host::InterruptibleLink broken(link, link, interrupt);
      host::InterruptibleClock clock(link, interrupt);
      link.request = [&, requests = 0](Bytes wire) mutable {
        if (++requests == at) interrupt.request();
        return wire;
      };
      hil::BusRunOptions options;
      options.family = family_of(model);
      options.allowed = kAll;
      options.interrupt = &interrupt;
      const auto report = hil::run_bus_suite(broken, clock, options);
      ASSERT_TRUE(report) << report.error().message;
      EXPECT_EQ(memory_of(*bus), before) << model << " interrupted at request " << at;
      if (!report->interrupted) break;
    }
  }
}

}  // namespace
}  // namespace kaz::test
