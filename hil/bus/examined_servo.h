// A servo under test: requests, answers, and registers to restore.
// SPDX-License-Identifier: Apache-2.0
//
// Failed checks throw Failed. A lost port or an interrupt throws Lost (hil/report/check.h).
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "hil/bus/servo_table.h"
#include "hil/report/check.h"
#include "host/link/link.h"

namespace kaz::hil {

class ExaminedServo {
 public:
  // `link` must be set to the servo's baud rate. `link` and `clock` must outlive this object.
  ExaminedServo(host::Link& link, host::Clock& clock, ServoFamily family, int id)
      : link_(link), clock_(clock), family_(family), id_(id) {}

  // Finds the servo's register table. Errors (environment): no answer; unknown model; the torque is on and
  // `release` is false; the servo's settings suppress answers to writes. If the response level of a Feetech
  // servo reads 0, one write decides.
  Result<void> identify(bool release);
  const ServoTable& table() const { return *table_; }
  int id() const { return id_; }
  int firmware() const { return firmware_; }
  // Returns a text such as "sts3215, id 3, firmware 3.9".
  std::string title() const;

  void begin_case() { transcript_.clear(); }
  // Restores the registers and switches the torque off. Throws Failed if the servo does not confirm that the
  // torque is off, or if registers could not be restored. The error message names these registers. `moves`:
  // whether the case is allowed to move the servo. If `moves` is false and the torque was on when end_case()
  // was called, throws Failed.
  void end_case(bool moves);
  const std::vector<std::string>& transcript() const { return transcript_; }
  // Returns whether end_case() still has registers to restore.
  bool altered() const { return !before_.empty(); }

  // ---- Requests

  // Sends raw bytes and fails if an answer arrives within `window`. `else_what` is the beginning of the error
  // message.
  void silent(const Bytes& wire, const std::string& else_what, Time window = kSilence);
  // Sends raw bytes and returns `count` answers. Fails if more or fewer answers, or damaged answers, arrive
  // before the timeout.
  std::vector<ServoAnswer> answers(const Bytes& wire, std::size_t count);
  // Sends raw bytes and returns the first answer, if one arrives. Fails if the answer is damaged.
  std::optional<ServoAnswer> maybe(const Bytes& wire);
  // Sends a request and returns the answer of this servo.
  ServoAnswer answer(int instruction, const Bytes& parameters = {});
  // Waits without sending or reading.
  void pause(Time time);
  void send(const Bytes& wire);

  Bytes request(int instruction, const Bytes& parameters = {}) const {
    return servo_request(family_, id_, instruction, parameters);
  }
  // Return the parameters of a read request and of a write request.
  Bytes read_of(int address, int size) const;
  Bytes write_of(int address, const Bytes& data) const;
  Bytes read(int address, int size);
  long value(const ServoRow& row);
  // Writes a register and returns the error code of the answer; 0: success. The alert bit of the answer is
  // ignored. For Feetech servos, the result is always 0. end_case() restores the old value.
  int write(const ServoRow& row, long value);
  // Stores the present value of a register, so that end_case() can restore this value. write() calls keep().
  // If you write a register without write(), call keep() first.
  void keep(const ServoRow& row);

  // Waiting times: kSilence to check that no answer comes, kPatience for an expected answer.
  static constexpr Time kSilence = std::chrono::milliseconds(60);
  static constexpr Time kPatience = std::chrono::milliseconds(300);

 private:
  struct Torque {
    // `off`: the servo has confirmed that the torque is off. `was_on`: the torque was on when release() was
    // called.
    bool off = false, was_on = false;
  };
  Torque release();
  bool answers_a_write();
  Bytes exchange(const Bytes& wire, std::size_t count, Time window);
  void note(char direction, const Bytes& bytes);
  int error_of(const ServoAnswer& answer) const;
  std::vector<std::string> put_back();

  host::Link& link_;
  host::Clock& clock_;
  ServoFamily family_;
  int id_;
  const ServoTable* table_ = nullptr;
  int firmware_ = 0;
  std::string version_;
  bool echo_ = false;                       // the adapter echoes requests
  std::map<const ServoRow*, long> before_;  // original values of the written registers
  std::vector<std::string> transcript_;
};

}  // namespace kaz::hil
