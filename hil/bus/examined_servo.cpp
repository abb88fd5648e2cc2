// A servo under examination.
// SPDX-License-Identifier: Apache-2.0
#include "hil/bus/examined_servo.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "host/link/drain.h"

namespace kaz::hil {
namespace {

constexpr int kRead = 2, kWrite = 3;
constexpr int kAlert = 0x80;  // of ROBOTIS's: a hardware error is there, whatever the request
constexpr std::size_t kMostBytes = 2000;

std::string text_of(const Bytes& bytes) {
  std::string text;
  char two[4];
  for (const std::uint8_t byte : bytes) {
    std::snprintf(two, sizeof two, "%s%02X", text.empty() ? "" : " ", byte);
    text += two;
  }
  return text;
}

const ServoRow& torque_row(const ServoTable& table) {
  return *table.find({"torque switch", "Torque Enable"});
}

}  // namespace

void ExaminedServo::note(char direction, const Bytes& bytes) {
  if (!bytes.empty()) transcript_.push_back(std::string(1, direction) + " " + text_of(bytes));
}

void ExaminedServo::send(const Bytes& wire) {
  // Written also after an error: it may be what switches the torque off.
  const auto drained = host::drain(link_, clock_);
  note('>', wire);
  sure(link_.write(wire));
  sure(drained);
}

// What comes until there are `count` answers, or the window is over. The window follows the last byte sent.
Bytes ExaminedServo::exchange(const Bytes& wire, std::size_t count, Time window) {
  send(wire);
  const Time sent = static_cast<std::int64_t>(wire.size()) * link_.byte_time();
  const Time until = clock_.now() + sent + window;
  Bytes come;
  std::array<std::uint8_t, 256> bytes{};
  while (clock_.now() < until && come.size() < kMostBytes) {
    const std::size_t got = sure(link_.read(bytes, until));
    come.insert(come.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(got));
    const bool whole_echo = echo_ && come.size() < wire.size();
    if (whole_echo) continue;
    const auto begin = come.begin() + (echo_ ? static_cast<std::ptrdiff_t>(wire.size()) : 0);
    const auto found = answers_in(family_, Bytes(begin, come.end()));
    if (count > 0 && !found.open &&
        found.all.size() + static_cast<std::size_t>(found.damaged) >= count)
      break;
  }
  if (echo_ && come.size() >= wire.size())
    come.erase(come.begin(), come.begin() + static_cast<std::ptrdiff_t>(wire.size()));
  note('<', come);
  return come;
}

void ExaminedServo::silent(const Bytes& wire, const std::string& else_what, Time window) {
  check(exchange(wire, 0, window).empty(), else_what + ": expected no answer, got one");
}

std::vector<ServoAnswer> ExaminedServo::answers(const Bytes& wire, std::size_t count) {
  const auto found = answers_in(family_, exchange(wire, count, kPatience));
  check(found.damaged == 0, "an answer is damaged: its checksum, CRC or length is wrong");
  check(!found.open, "an answer is incomplete");
  equal("answers", static_cast<long>(found.all.size()), static_cast<long>(count));
  check(found.stray == 0, std::to_string(found.stray) + " bytes outside the answer");
  return found.all;
}

std::optional<ServoAnswer> ExaminedServo::maybe(const Bytes& wire) {
  const auto found = answers_in(family_, exchange(wire, 1, kSilence));
  check(found.damaged == 0 && !found.open, "an answer is damaged");
  if (found.all.empty()) return std::nullopt;
  return found.all[0];
}

ServoAnswer ExaminedServo::answer(int instruction, const Bytes& parameters) {
  const auto all = answers(request(instruction, parameters), 1);
  equal("id of the answer", all[0].id, id_);
  return all[0];
}

void ExaminedServo::pause(Time time) {
  sure(clock_.sleep_until(clock_.now() + time));
}

int ExaminedServo::error_of(const ServoAnswer& answer) const {
  // The status bits of Feetech's are the servo's condition, not the request's.
  return family_ == ServoFamily::feetech ? 0 : answer.error & ~kAlert;
}

Bytes ExaminedServo::read_of(int address, int size) const {
  const auto low = [](int n) { return static_cast<std::uint8_t>(n); };
  const auto high = [](int n) { return static_cast<std::uint8_t>(n >> 8); };
  if (family_ == ServoFamily::feetech) return {low(address), low(size)};
  return {low(address), high(address), low(size), high(size)};
}

Bytes ExaminedServo::write_of(int address, const Bytes& data) const {
  Bytes all{static_cast<std::uint8_t>(address)};
  if (family_ == ServoFamily::dynamixel) all.push_back(static_cast<std::uint8_t>(address >> 8));
  all.insert(all.end(), data.begin(), data.end());
  return all;
}

Bytes ExaminedServo::read(int address, int size) {
  const auto got = answer(kRead, read_of(address, size));
  equal("error of a read of address " + std::to_string(address), error_of(got), 0);
  equal("bytes read at address " + std::to_string(address), static_cast<long>(got.data.size()),
        size);
  return got.data;
}

long ExaminedServo::value(const ServoRow& row) {
  return decode(*table_, row, read(row.address, row.size));
}

void ExaminedServo::keep(const ServoRow& row) {
  if (!before_.contains(&row)) before_[&row] = value(row);
}

int ExaminedServo::write(const ServoRow& row, long value) {
  keep(row);
  const auto got = answer(kWrite, write_of(row.address, encode(*table_, row, value)));
  equal("bytes in the answer to a write", static_cast<long>(got.data.size()), 0);
  return error_of(got);
}

// Each a few times: on a real wire a request may be lost. Its answer proves nothing, the value read does.
std::vector<std::string> ExaminedServo::put_back() {
  std::vector<std::string> left;
  // Whether requests are answered comes first.
  const ServoRow* level = table_->find({"Status Return Level", "response status level"});
  std::vector<std::pair<const ServoRow*, long>> all(before_.begin(), before_.end());
  // clang 14 does not compile std::ranges::stable_partition of libstdc++ 12.
  std::stable_partition(all.begin(), all.end(),
                        [&](const auto& one) { return one.first == level; });
  for (const auto& [row, value] : all) {
    bool good = false;
    for (int tries = 0; tries < 3 && !good; ++tries) {
      try {
        if (tries > 0 || row == level || this->value(*row) != value)
          (void)maybe(request(kWrite, write_of(row->address, encode(*table_, *row, value))));
        good = this->value(*row) == value;
      } catch (const Failed&) {
      }
    }
    if (!good)
      left.push_back(row->what + " (address " + std::to_string(row->address) + "), which was " +
                     std::to_string(value));
  }
  before_.clear();
  return left;
}

// Goes on after a damaged answer: what is read back decides.
ExaminedServo::Torque ExaminedServo::release() {
  const ServoRow& torque = torque_row(*table_);
  const ServoRow* level = table_->find({"Status Return Level"});
  const auto attempt = [](const auto& request) {
    try {
      request();
    } catch (const Failed&) {
    }
  };
  Torque found;
  for (int tries = 0; tries < 3 && !found.off; ++tries) {
    // A case may have left it silent to reads.
    if (tries > 0 && level != nullptr && before_.contains(level))
      attempt([&] { (void)maybe(request(kWrite, write_of(level->address, {2}))); });
    attempt([&] {
      found.off = value(torque) == 0;
      found.was_on = found.was_on || !found.off;
    });
    if (found.off) break;
    attempt([&] { (void)maybe(request(kWrite, write_of(torque.address, {0}))); });
    attempt([&] { found.off = value(torque) == 0; });
  }
  return found;
}

void ExaminedServo::end_case(bool moves) {
  before_.erase(&torque_row(*table_));
  const auto [off, was_on] = release();
  const auto left = put_back();
  std::string wrong;
  for (const std::string& one : left) wrong += (wrong.empty() ? "not restored: " : ", ") + one;
  const std::string holds = "its torque is not confirmed to be off: cut its power";
  check(off, wrong.empty() ? holds : holds + "; " + wrong);
  check(wrong.empty(), wrong);
  check(moves || !was_on, "its torque came on unexpectedly");
}

// A servo may answer writes although its level reads 0, which an emulator without the register returns. The
// write switches the torque off, which is off already.
bool ExaminedServo::answers_a_write() {
  return maybe(request(kWrite, write_of(torque_row(*table_).address, {0}))).has_value();
}

Result<void> ExaminedServo::identify(bool release) {
  const auto refuse = [&](const std::string& text) {
    return fail(Fault::environment,
                "servo " + std::to_string(id_) + " on " + link_.name() + " " + text);
  };
  try {
    std::optional<ServoAnswer> first;
    // All tables of a family have the number at one place; the last one's order of bytes is the usual one.
    const ServoTable* any = nullptr;
    for (const ServoTable& one : servo_tables())
      if (one.family == family_) any = &one;
    const Bytes number = request(kRead, read_of(any->model_row().address, any->model_row().size));
    for (int tries = 0; tries < 5 && !first; ++tries) {
      Bytes come = exchange(number, 0, kSilence);
      if (come.size() >= number.size() && std::equal(number.begin(), number.end(), come.begin())) {
        echo_ = true;
        come.erase(come.begin(), come.begin() + static_cast<std::ptrdiff_t>(number.size()));
      }
      const auto found = answers_in(family_, come);
      for (const ServoAnswer& one : found.all)
        if (one.id == id_ && one.data.size() == 2) first = one;
    }
    if (!first)
      return refuse("does not answer: check its supply, plug, id and rate; `kaz bus scan --robot " +
                    std::string(family_ == ServoFamily::feetech ? "feetech:" : "dynamixel:") +
                    link_.name() + "` finds servos");
    for (const ServoTable& one : servo_tables())
      if (one.family == family_ &&
          decode(one, one.model_row(), first->data) == one.model_row().factory)
        table_ = &one;
    if (table_ == nullptr)
      return refuse(
          "has model number " + std::to_string(decode(*any, any->model_row(), first->data)) +
          ", which has no register table; docs/reference/servo-bus.md lists the known models");
    if (family_ == ServoFamily::dynamixel) {
      firmware_ = static_cast<int>(value(table_->row("Firmware Version")));
      version_ = std::to_string(firmware_);
    } else {
      version_ = std::to_string(value(table_->row("firmware main version"))) + "." +
                 std::to_string(value(table_->row("firmware sub version")));
    }
    if (release && !this->release().off)
      return refuse("does not confirm that its torque is off: cut its power");
    if (!release && value(torque_row(*table_)) != 0)
      return refuse(
          "has its torque on: end the program that drives it, or give --release to switch the "
          "torque off (the load then falls)");
    const ServoRow& level =
        *table_->find({"Status Return Level", "response status level", "response level"});
    const long all = family_ == ServoFamily::dynamixel ? 2 : 1;
    const long now = value(level);
    if (now != all && !(family_ == ServoFamily::feetech && now == 0 && answers_a_write()))
      return refuse("answers only reads: the suite needs " + level.what + " " +
                    std::to_string(all));
  } catch (const Failed& failed) {
    return refuse("gives a wrong first answer: " + failed.message);
  } catch (const Lost& lost) {
    return tl::unexpected(lost.error);
  }
  before_.clear();
  return {};
}

std::string ExaminedServo::title() const {
  if (table_ == nullptr) return "";
  return table_->model + ", id " + std::to_string(id_) + ", firmware " + version_;
}

}  // namespace kaz::hil
