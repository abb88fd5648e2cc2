// A servo under examination: requests, their answers, and what has to be put back.
// SPDX-License-Identifier: Apache-2.0
//
// Checks throw Failed; a lost port or an interruption throws Lost (hil/report/check.h).
#pragma once

#include <initializer_list>
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
  // `link` is at the servo's rate.
  ExaminedServo(host::Link& link, host::Clock& clock, ServoFamily family, int id)
      : link_(link), clock_(clock), family_(family), id_(id) {}

  // Finds its table. Errors (environment): nobody answers; of no known model; its torque is on, unless
  // `release` switches it off; it does not answer writes.
  Result<void> identify(bool release);
  const ServoTable& table() const { return *table_; }
  int id() const { return id_; }
  int firmware() const { return firmware_; }
  // "sts3215, id 3, firmware 3.9"
  std::string title() const;

  void begin_case() { transcript_.clear(); }
  // Registers and torque as they were before the case. Throws Failed, naming what could not be put back, or
  // if the torque was on although the case needs none.
  void end_case(bool moves);
  const std::vector<std::string>& transcript() const { return transcript_; }
  // A register whose value is not the one found.
  bool altered() const { return !before_.empty(); }

  // ---- Requests
  // Bytes as they are; nobody answers. `window`: how long it is listened.
  void silent(const Bytes& wire, const std::string& else_what, Time window = kSilence);
  // Exactly so many answers, in time.
  std::vector<ServoAnswer> answers(const Bytes& wire, std::size_t count);
  // The answers that come, one or none.
  std::optional<ServoAnswer> maybe(const Bytes& wire);
  // Its own answer.
  ServoAnswer answer(int instruction, const Bytes& parameters = {});
  // Listens; nothing is sent.
  void pause(Time time);
  void send(const Bytes& wire);

  Bytes request(int instruction, const Bytes& parameters = {}) const {
    return servo_request(family_, id_, instruction, parameters);
  }
  // Parameters of reads and writes.
  Bytes read_of(int address, int size) const;
  Bytes write_of(int address, const Bytes& data) const;
  Bytes read(int address, int size);
  long value(const ServoRow& row);
  // The error that it answers, without alerts: 0 done. What the register held is put back by end_case().
  int write(const ServoRow& row, long value);
  void keep(const ServoRow& row);  // for a write by other means

  static constexpr Time kSilence = std::chrono::milliseconds(60);
  static constexpr Time kPatience = std::chrono::milliseconds(300);

 private:
  struct Torque {
    bool off = false, was_on = false;  // as read back, and before
  };
  Torque release();
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
  bool echo_ = false;                       // the adapter hands requests back
  std::map<const ServoRow*, long> before_;  // of registers that were written
  std::vector<std::string> transcript_;
};

}  // namespace kaz::hil
