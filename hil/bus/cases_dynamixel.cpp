// Cases of ROBOTIS's bus, protocol 2.0.
// SPDX-License-Identifier: Apache-2.0
#include "hil/bus/bus_suite.h"

namespace kaz::hil {
namespace {

using namespace std::chrono_literals;

constexpr int kPing = 1, kRead = 2, kWrite = 3, kRegWrite = 4, kAction = 5, kUnknown = 0x0F,
              kSyncRead = 0x82, kSyncWrite = 0x83, kFastSyncRead = 0x8A, kBulkRead = 0x92,
              kBulkWrite = 0x93, kFastBulkRead = 0x9A;
constexpr int kInstructionError = 2, kCrcError = 3, kRangeError = 4, kLengthError = 5,
              kAccessError = 7;
constexpr auto kDynamixel = ServoFamily::dynamixel;

int error_of(const ServoAnswer& answer) {
  return answer.error & 0x7F;  // without the alert
}

const ServoRow& led(const ExaminedServo& servo) {
  return servo.table().row("LED");
}
const ServoRow& profile(const ExaminedServo& servo) {
  return servo.table().row("Profile Velocity");
}

int other_id(ExaminedServo& servo) {
  for (int id = 250; id > 200; --id) {
    if (id != servo.id() && !servo.maybe(servo_request(kDynamixel, id, kPing))) return id;
  }
  throw Failed{"no unused id was found: every id from 201 to 250 answers"};
}

void ping(ExaminedServo& servo) {
  const auto got = servo.answer(kPing);
  equal("error", error_of(got), 0);
  equal("bytes in the answer to a ping", static_cast<long>(got.data.size()), 3);
  const ServoRow& model = servo.table().model_row();
  equal("model in the answer to a ping",
        decode(servo.table(), model, {got.data.begin(), got.data.begin() + 2}), servo.value(model));
  equal("firmware in the answer to a ping", got.data[2],
        servo.value(servo.table().row("Firmware Version")));
}

bool has_fast_reads(const ServoTable& table, int firmware) {
  return firmware >= (table.model.starts_with("xl330") ? 46 : 45);
}

Bytes with_id(Bytes parameters, int id) {
  parameters.push_back(static_cast<std::uint8_t>(id));
  return parameters;
}

void append(Bytes& to, const Bytes& bytes) {
  to.insert(to.end(), bytes.begin(), bytes.end());
}

void add_packet_cases(ServoCases cases) {
  cases.add("packet.ping", "The answer to a ping contains model and firmware version.", "packet",
            ping);
  cases.add("packet.crc", "A request with a wrong CRC is not executed.", "packet",
            [](ExaminedServo& servo) {
              servo.keep(led(servo));
              const long before = servo.value(led(servo));
              const Bytes write = servo.request(
                  kWrite, servo.write_of(led(servo).address,
                                         encode(servo.table(), led(servo), 1 - before)));
              if (const auto got = servo.maybe(damaged(write)))
                equal("error", error_of(*got), kCrcError);
              equal("LED", servo.value(led(servo)), before);
            });
  cases.add("packet.other-id", "A request to another id is not answered.", "packet",
            [](ExaminedServo& servo) {
              servo.silent(servo_request(kDynamixel, other_id(servo), kPing),
                           "ping to an unused id");
            });
  cases.add(
      "packet.noise-before", "Bytes before a packet are ignored.", "packet",
      [](ExaminedServo& servo) {
        for (const Bytes& noise : {Bytes{0}, Bytes{0x55, 0xAA, 0x00}, Bytes{0xFF, 0xFF, 0x00}}) {
          Bytes wire = noise;
          append(wire, servo.request(kPing));
          equal("id", servo.answers(wire, 1)[0].id, servo.id());
        }
      });
  cases.add("packet.cut", "An incomplete packet is discarded after a pause.", "packet",
            [](ExaminedServo& servo) {
              Bytes request = servo.request(kPing);
              request.resize(8);
              servo.silent(request, "the first eight bytes of a ping", 50ms);
              ping(servo);
            });
  cases.add(
      "packet.stuffing",
      "If parameters contain the bytes FF FF FD FD, the servo discards the second FD as stuffing.",
      "packet", [](ExaminedServo& servo) {
        // With the FD as data it would be five bytes for a register of four.
        servo.keep(profile(servo));
        const long before = servo.value(profile(servo));
        const auto got =
            servo.answer(kWrite, servo.write_of(profile(servo).address, {0xFF, 0xFF, 0xFD, 0x00}));
        equal("error", error_of(got), kRangeError);
        equal("Profile Velocity", servo.value(profile(servo)), before);
      });
  cases.add("packet.all-answered", "100 requests get 100 answers.", "line",
            [](ExaminedServo& servo) {
              const ServoRow& row = servo.table().model_row();
              for (int i = 0; i < 100; ++i) equal(row.what, servo.value(row), *row.factory);
            });
}

void add_error_cases(ServoCases cases) {
  const auto error = [](ExaminedServo& servo, int instruction, const Bytes& parameters,
                        int wanted) {
    equal("error", error_of(servo.answer(instruction, parameters)), wanted);
  };
  cases.add("errors.instruction", "An unknown instruction gets error 2.", "packet",
            [error](ExaminedServo& servo) { error(servo, kUnknown, {}, kInstructionError); });
  cases.add("errors.action",
            "An `action` instruction without an earlier `reg write` instruction gets error 2.",
            "packet", [error](ExaminedServo& servo) {
              equal("Registered Instruction",
                    servo.value(servo.table().row("Registered Instruction")), 0);
              error(servo, kAction, {}, kInstructionError);
            });
  cases.add("errors.length", "A write to part of a register gets error 5.", "packet",
            [error](ExaminedServo& servo) {
              servo.keep(profile(servo));
              const long before = servo.value(profile(servo));
              error(servo, kWrite, servo.write_of(profile(servo).address, {1, 0}), kLengthError);
              equal("Profile Velocity", servo.value(profile(servo)), before);
            });
  cases.add(
      "errors.range", "A value outside a register's range gets error 4 and is not written.",
      "packet", [](ExaminedServo& servo) {
        for (const ServoRow& row : servo.table().rows) {
          if (!row.what.ends_with("Gain") && !row.what.starts_with("Profile") && row.what != "LED")
            continue;
          if (!row.writable || row.max >= row.highest()) continue;
          const long before = servo.value(row);
          equal(row.what + ": error of writing " + std::to_string(row.max + 1),
                servo.write(row, row.max + 1), kRangeError);
          equal(row.what, servo.value(row), before);
        }
      });
  cases.add("errors.read-outside",
            "A read of an address without a register gets error 7 and no data.", "packet",
            [](ExaminedServo& servo) {
              const auto got = servo.answer(kRead, servo.read_of(60000, 2));
              equal("error", error_of(got), kAccessError);
              equal("bytes", static_cast<long>(got.data.size()), 0);
            });
}

void add_group_cases(ServoCases cases) {
  cases.add("groups.sync-read", "A sync read gets the same data as a read of the same register.",
            "packet", [](ExaminedServo& servo) {
              const ServoRow& row = servo.table().model_row();
              const auto all = servo.answers(
                  servo_request(kDynamixel, kAllServos, kSyncRead,
                                with_id(servo.read_of(row.address, row.size), servo.id())),
                  1);
              equal("id", all[0].id, servo.id());
              check(all[0].data == servo.read(row.address, row.size),
                    "the data of the sync read differ from the data of the read");
            });
  cases.add("groups.sync-read-of-others", "A sync read without the servo's id is not answered.",
            "packet", [](ExaminedServo& servo) {
              servo.silent(servo_request(kDynamixel, kAllServos, kSyncRead,
                                         with_id(servo.read_of(0, 2), other_id(servo))),
                           "a sync read of another id");
            });
  cases.add("groups.bulk-read", "A bulk read gets the same data as a read of the same registers.",
            "packet", [](ExaminedServo& servo) {
              Bytes parameters{static_cast<std::uint8_t>(servo.id())};
              append(parameters, servo.read_of(0, 7));
              const auto all =
                  servo.answers(servo_request(kDynamixel, kAllServos, kBulkRead, parameters), 1);
              equal("id", all[0].id, servo.id());
              check(all[0].data == servo.read(0, 7),
                    "the data of the bulk read differ from the data of the read");
            });
  for (const bool bulk : {false, true}) {
    cases.add(
        bulk ? "groups.fast-bulk-read" : "groups.fast-sync-read",
        "A fast read is answered with one packet, which contains error, id and data of each servo.",
        "packet",
        [bulk](ExaminedServo& servo) {
          Bytes parameters = servo.read_of(0, 7);
          if (bulk)
            parameters.insert(parameters.begin(), static_cast<std::uint8_t>(servo.id()));
          else
            parameters = with_id(parameters, servo.id());
          const auto all =
              servo.answers(servo_request(kDynamixel, kAllServos,
                                          bulk ? kFastBulkRead : kFastSyncRead, parameters),
                            1);
          equal("id of the packet", all[0].id, kAllServos);
          equal("error", error_of(all[0]), 0);
          Bytes wanted{static_cast<std::uint8_t>(servo.id())};
          append(wanted, servo.read(0, 7));
          check(all[0].data == wanted,
                "the id in the answer to the fast read is wrong, or the data differ from the data "
                "of a normal read");
        },
        kServoNothing, has_fast_reads);
  }
  for (const bool bulk : {false, true}) {
    cases.add(
        bulk ? "groups.bulk-write" : "groups.sync-write",
        "A write to a group is executed and not answered.", "packet", [bulk](ExaminedServo& servo) {
          const ServoRow& row = profile(servo);
          servo.keep(row);
          const int other = other_id(servo);
          for (const long value : {9L, 11L}) {
            // As the first of the list, and as the last.
            const std::vector<std::pair<int, long>> list =
                value == 9 ? std::vector<std::pair<int, long>>{{servo.id(), 9}, {other, 3}}
                           : std::vector<std::pair<int, long>>{{other, 3}, {servo.id(), 11}};
            Bytes parameters = bulk ? Bytes() : servo.read_of(row.address, row.size);
            for (const auto& [id, number] : list) {
              parameters.push_back(static_cast<std::uint8_t>(id));
              if (bulk) append(parameters, servo.read_of(row.address, row.size));
              append(parameters, encode(servo.table(), row, number));
            }
            servo.silent(
                servo_request(kDynamixel, kAllServos, bulk ? kBulkWrite : kSyncWrite, parameters),
                "a write to a group");
            equal(row.what, servo.value(row), value);
          }
        });
  }
}

void add_instruction_cases(ServoCases cases) {
  cases.add("instructions.reg-write",
            "The servo executes a `reg write` instruction only after the servo receives an "
            "`action` instruction.",
            "packet", [](ExaminedServo& servo) {
              const ServoRow& row = profile(servo);
              const ServoRow& waits = servo.table().row("Registered Instruction");
              servo.keep(row);
              const long before = servo.value(row), other = before == 7 ? 8 : 7;
              equal("error",
                    error_of(servo.answer(
                        kRegWrite, servo.write_of(row.address, encode(servo.table(), row, other)))),
                    0);
              equal(row.what + " before the action", servo.value(row), before);
              equal(waits.what + " before the action", servo.value(waits), 1);
              equal("error in the answer to `action`", error_of(servo.answer(kAction)), 0);
              equal(row.what + " after the action", servo.value(row), other);
              equal(waits.what + " after the action", servo.value(waits), 0);
            });
  cases.add(
      "instructions.status-return-level",
      "At status return level 0, the servo answers only pings; at level 1, it answers pings and "
      "reads.",
      "packet", [](ExaminedServo& servo) {
        const ServoRow& level = servo.table().row("Status Return Level");
        const auto level_to = [&](int value) {
          (void)servo.maybe(servo.request(
              kWrite, servo.write_of(level.address, {static_cast<std::uint8_t>(value)})));
        };
        servo.keep(level);
        servo.keep(led(servo));
        level_to(1);
        const long lit = servo.value(led(servo));
        servo.silent(servo.request(kWrite, servo.write_of(led(servo).address,
                                                          {static_cast<std::uint8_t>(1 - lit)})),
                     "a write at level 1");
        equal("LED", servo.value(led(servo)), 1 - lit);
        level_to(0);
        servo.silent(servo.request(kRead, servo.read_of(0, 2)), "a read at level 0");
        equal("bytes in the answer to a ping at level 0",
              static_cast<long>(servo.answer(kPing).data.size()), 3);
        level_to(2);
        equal("Status Return Level", servo.value(level), 2);
      });
  cases.add("instructions.indirect",
            "If `Indirect Address 1` contains the address of a register, a read or write of "
            "`Indirect Data 1` accesses this register.",
            "registers", [](ExaminedServo& servo) {
              const ServoTable& table = servo.table();
              servo.keep(led(servo));
              equal("error", servo.write(table.row("Indirect Address 1"), led(servo).address), 0);
              for (const long lit : {1L, 0L}) {
                servo.write(led(servo), lit);
                equal("Indirect Data 1", servo.value(table.row("Indirect Data 1")), lit);
              }
              const ServoRow& data = table.row("Indirect Data 1");
              equal("error of a write through the indirect address",
                    error_of(servo.answer(kWrite, servo.write_of(data.address, {1}))), 0);
              equal("LED", servo.value(led(servo)), 1);
            });
  add_write_to_all(cases, kDynamixel, profile);
  for (const char* one : {"factory-reset", "reboot", "clear", "backup"})
    cases.add(
        std::string("instructions.") + one, "The instruction " + std::string(one) + ".", "packet",
        [](ExaminedServo&) {}, kServoNever);
}

}  // namespace

void add_dynamixel_cases(std::vector<ServoCase>& all) {
  const ServoCases cases{all, "servo-bus.md"};
  add_packet_cases(cases);
  add_error_cases(cases);
  add_group_cases(cases);
  add_instruction_cases(cases);
  add_register_cases(cases, kDynamixel);
  add_motion_cases(cases, kDynamixel);
}

}  // namespace kaz::hil
