// Cases of Feetech's bus.
// SPDX-License-Identifier: Apache-2.0
#include "hil/bus/bus_suite.h"

namespace kaz::hil {
namespace {

using namespace std::chrono_literals;

constexpr int kPing = 1, kWrite = 3, kRegWrite = 4, kAction = 5, kSyncRead = 0x82,
              kSyncWrite = 0x83;
constexpr auto kFeetech = ServoFamily::feetech;

// RAM that moves nothing while the torque is off.
const ServoRow& probe(const ExaminedServo& servo) {
  return *servo.table().find({"acceleration", "goal speed"});
}

// An id at which nobody answers.
int other_id(ExaminedServo& servo) {
  for (int id = 250; id > 200; --id) {
    if (id != servo.id() && !servo.maybe(servo_request(kFeetech, id, kPing))) return id;
  }
  throw Failed{"every id from 201 to 250 answers"};
}

bool is_sts(const ServoTable& table, int) {
  return table.model.starts_with("sts");
}

void ping(ExaminedServo& servo) {
  equal("bytes in the answer to a ping", static_cast<long>(servo.answer(kPing).data.size()), 0);
}

void add_packet_cases(ServoCases cases) {
  cases.add("packet.ping", "The answer to a ping contains no data.", "packet", ping);
  cases.add("packet.checksum", "A request with a wrong checksum is not executed.", "packet",
            [](ExaminedServo& servo) {
              const ServoRow& row = probe(servo);
              servo.keep(row);
              const long before = servo.value(row);
              const Bytes write = servo.request(
                  kWrite, servo.write_of(row.address, encode(servo.table(), row, before ^ 1)));
              (void)servo.maybe(damaged(write));
              equal(row.what, servo.value(row), before);
            });
  cases.add("packet.other-id", "A request to another id is not answered.", "packet",
            [](ExaminedServo& servo) {
              servo.silent(servo_request(kFeetech, other_id(servo), kPing), "ping to an unused id");
            });
  cases.add("packet.noise-before", "Bytes before a packet are ignored.", "packet",
            [](ExaminedServo& servo) {
              for (const Bytes& noise : {Bytes{0}, Bytes{0x55, 0xAA, 0x00}, Bytes{0xFF, 0x00}}) {
                Bytes wire = noise;
                const Bytes request = servo.request(kPing);
                wire.insert(wire.end(), request.begin(), request.end());
                equal("id", servo.answers(wire, 1)[0].id, servo.id());
              }
            });
  cases.add("packet.cut", "An incomplete packet is discarded after a pause.", "packet",
            [](ExaminedServo& servo) {
              Bytes request = servo.request(kPing);
              request.resize(4);
              servo.silent(request, "the first four bytes of a ping", 200ms);
              ping(servo);
            });
  cases.add("packet.all-answered", "100 requests get 100 answers.", "line",
            [](ExaminedServo& servo) {
              const ServoRow& row = servo.table().model_row();
              for (int i = 0; i < 100; ++i) equal(row.what, servo.value(row), *row.factory);
            });
}

void add_instruction_cases(ServoCases cases) {
  cases.add("instructions.reg-write",
            "The servo executes a `reg write` instruction only after the servo receives an "
            "`action` instruction.",
            "packet", [](ExaminedServo& servo) {
              const ServoRow& row = probe(servo);
              const ServoRow& waits =
                  *servo.table().find({"asynchronous write flag", "asynchronous flag"});
              servo.keep(row);
              const long before = servo.value(row), other = before == 7 ? 8 : 7;
              servo.answer(kRegWrite,
                           servo.write_of(row.address, encode(servo.table(), row, other)));
              equal(row.what + " before the action", servo.value(row), before);
              equal(waits.what + " before the action", servo.value(waits), 1);
              servo.answer(kAction);
              equal(row.what + " after the action", servo.value(row), other);
              equal(waits.what + " after the action", servo.value(waits), 0);
            });
  cases.add("instructions.sync-write", "A sync write is executed and not answered.", "packet",
            [](ExaminedServo& servo) {
              const ServoRow& row = probe(servo);
              servo.keep(row);
              const int other = other_id(servo);
              for (const long value : {9L, 11L}) {
                const Bytes data = encode(servo.table(), row, value),
                            wrong = encode(servo.table(), row, 3);
                Bytes parameters{static_cast<std::uint8_t>(row.address),
                                 static_cast<std::uint8_t>(row.size)};
                const auto add = [&](int id, const Bytes& bytes) {
                  parameters.push_back(static_cast<std::uint8_t>(id));
                  parameters.insert(parameters.end(), bytes.begin(), bytes.end());
                };
                // First in the list, and last.
                if (value == 11) add(other, wrong);
                add(servo.id(), data);
                if (value == 9) add(other, wrong);
                servo.silent(servo_request(kFeetech, kAllServos, kSyncWrite, parameters),
                             "a sync write");
                equal(row.what, servo.value(row), value);
              }
            });
  cases.add(
      "instructions.sync-read", "A sync read gets the same data as a read of the same register.",
      "packet",
      [](ExaminedServo& servo) {
        const ServoRow& row = servo.table().model_row();
        Bytes parameters = servo.read_of(row.address, row.size);
        parameters.push_back(static_cast<std::uint8_t>(servo.id()));
        const auto all =
            servo.answers(servo_request(kFeetech, kAllServos, kSyncRead, parameters), 1);
        equal("id", all[0].id, servo.id());
        check(all[0].data == servo.read(row.address, row.size),
              "the data of the sync read differ from the data of the read");
      },
      kServoNothing, is_sts);
  cases.add(
      "instructions.sync-read-of-others", "A sync read without the servo's id is not answered.",
      "packet",
      [](ExaminedServo& servo) {
        Bytes parameters = servo.read_of(3, 2);
        parameters.push_back(static_cast<std::uint8_t>(other_id(servo)));
        servo.silent(servo_request(kFeetech, kAllServos, kSyncRead, parameters),
                     "a sync read of another id");
      },
      kServoNothing, is_sts);
  add_write_to_all(cases, kFeetech, probe);
  cases.add(
      "instructions.response-level", "At response level 0, the servo answers only pings and reads.",
      "packet",
      [](ExaminedServo& servo) {
        const ServoRow& level = *servo.table().find({"response status level", "response level"});
        const ServoRow& row = probe(servo);
        servo.keep(level);
        servo.keep(row);
        (void)servo.maybe(servo.request(kWrite, servo.write_of(level.address, {0})));
        const long value = servo.value(row) == 5 ? 6 : 5;
        servo.silent(
            servo.request(kWrite, servo.write_of(row.address, encode(servo.table(), row, value))),
            "a write at level 0");
        equal(row.what, servo.value(row), value);
        ping(servo);
      },
      kServoEeprom);
  for (const char* one : {"restore", "restart", "backup", "reset-turns", "set-middle"})
    cases.add(
        std::string("instructions.") + one, "The instruction " + std::string(one) + ".", "packet",
        [](ExaminedServo&) {}, kServoNever);
}

}  // namespace

void add_feetech_cases(std::vector<ServoCase>& all) {
  const ServoCases cases{all, "servo-bus.md"};
  add_packet_cases(cases);
  add_instruction_cases(cases);
  add_register_cases(cases, kFeetech);
  add_motion_cases(cases, kFeetech);
}

}  // namespace kaz::hil
