// Ranges of joints on a servo bus by hand, and what is written of them.
// SPDX-License-Identifier: Apache-2.0
#include "tools/calibrate/calibrate_bus.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <optional>
#include <vector>

#include <nlohmann/json.hpp>

#include "host/bus/joint_range.h"
#include "host/link/wall_clock.h"
#include "shared/base/files.hpp"
#include "tools/base/arguments.h"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/base/output_file.h"
#include "tools/base/prompt.h"
#include "tools/base/provenance.h"
#include "tools/kept/kept_run.h"
#include "tools/run/backend.h"

namespace kaz::tools {
namespace {

using host::BusDriver;
using host::BusJoint;
using host::named;
using host::RangePlan;
using host::RangeRegisters;
using host::RangeSweep;
using servo_bus::BusServo;
using servo_bus::Protocol;
using Json = nlohmann::ordered_json;

constexpr const char* kVerb = "kaz calibrate joints";
constexpr double kPerDegree = 180 / std::numbers::pi;
constexpr Time kPeriod = std::chrono::milliseconds(20);
constexpr Time kLost = std::chrono::seconds(2), kSettled = std::chrono::milliseconds(1500);
// Of a joint's range: it has been at both stops.
constexpr double kWhole = 0.97;
constexpr int kCountsTurns = 16;  // bit of `phase`
// Steps by which a limp arm may sag while its EEPROM is written.
constexpr double kSags = 40;
constexpr const char* kNobody =
    "writing to the servos needs somebody at the keyboard, or --yes for a script; nothing was "
    "written";

const OutputKind& joints_output() {
  static const OutputKind kind{"calibrate joints", {"result.json", "joints.svg"}};
  return kind;
}

// The registers that Feetech's and ROBOTIS's have for the same.
struct Names {
  const char *offset, *low, *high;
};
Names names_of(Protocol protocol) {
  return protocol == Protocol::feetech
             ? Names{"position_offset", "min_angle", "max_angle"}
             : Names{"homing_offset", "min_position_limit", "max_position_limit"};
}

struct Change {
  const char* name;
  int before, after;
};

std::vector<Change> changes_of(const Names& names, const RangeRegisters& before,
                               const RangeRegisters& after) {
  std::vector<Change> all;
  for (const Change& one : {Change{names.offset, before.offset, after.offset},
                            {names.low, before.low, after.low},
                            {names.high, before.high, after.high}})
    if (one.before != one.after) all.push_back(one);
  return all;
}

// The servos' registers and positions, on one port.
class CalibratedServos {
 public:
  CalibratedServos(Protocol protocol, std::unique_ptr<host::PortLink> port, host::Clock& clock)
      : protocol_(protocol),
        port_(std::move(port)),
        driver_(BusDriver::make(protocol, *port_, clock)) {}

  Protocol protocol() const { return protocol_; }
  std::string port() const { return port_->name(); }
  BusDriver& driver() { return *driver_; }

  tl::unexpected<Error> silent(const BusServo& servo) const {
    return tl::unexpected(silent_servo(servo, port_->name()));
  }
  Result<int> read(const BusServo& servo, std::string_view name) {
    const auto value = KAZ_TRY(driver_->read(servo, name));
    if (!value) return silent(servo);
    return *value;
  }

  Result<RangeRegisters> registers_of(const BusServo& servo) {
    const Names names = names_of(protocol_);
    RangeRegisters now;
    if (servo.model->find(names.offset) != nullptr) now.offset = KAZ_TRY(read(servo, names.offset));
    now.low = KAZ_TRY(read(servo, names.low));
    now.high = KAZ_TRY(read(servo, names.high));
    // DYNAMIXEL counts turns always, and forgets them itself.
    if (protocol_ == Protocol::feetech && servo.model->full_turn)
      now.counts_turns = (KAZ_TRY(read(servo, "phase")) & kCountsTurns) != 0;
    return now;
  }

  // Writes the registers that differ.
  Result<void> write(const BusServo& servo, const RangeRegisters& from, const RangeRegisters& to) {
    const auto changes = changes_of(names_of(protocol_), from, to);
    if (changes.empty()) return {};
    const bool locks = servo.model->find("lock") != nullptr;
    const int locked = locks ? KAZ_TRY(read(servo, "lock")) : 0;
    if (locks) KAZ_TRY(set(servo, "lock", 0));
    Result<void> done;
    for (const Change& one : changes)
      if (done) done = set(servo, one.name, one.after);
    if (locks) done = together(done, set(servo, "lock", locked));
    return done;
  }

  Result<double> position(const BusServo& servo) {
    const BusServo* one[] = {&servo};
    for (int tries = 0; tries < 3; ++tries) {
      const auto states = KAZ_TRY(driver_->read_all(one));
      if (states[0]) return states[0]->steps;
    }
    return silent(servo);
  }

 private:
  // Read back; a write that was not acknowledged may have been done.
  Result<void> set(const BusServo& servo, const char* name, int value) {
    for (int tries = 0; tries < 3; ++tries) {
      (void)KAZ_TRY(driver_->write(servo, name, value));
      const auto now = KAZ_TRY(driver_->read(servo, name));
      if (now == value) return {};
    }
    return fail(Fault::environment, named(servo) + " on " + port_->name() + " does not accept " +
                                        std::to_string(value) + " for its register " + name);
  }

  Protocol protocol_;
  std::unique_ptr<host::PortLink> port_;
  std::unique_ptr<BusDriver> driver_;  // refers to the port
};

class BusCalibration {
 public:
  explicit BusCalibration(const BusCalibrationOptions& options) : options_(options) {}

  Result<ExitStatus> run() {
    const InterruptSignals signals(interrupt_);
    if (!options_.out.empty()) folder_ = KAZ_TRY(OutputFolder::open(options_.out, joints_output()));
    file_.path = servo_bus::bus_file_path(options_.backend.robot_file);
    auto bus = KAZ_TRY(open_servo_bus(options_.backend, interrupt_));
    joints_ = std::move(bus.joints);
    file_.text = KAZ_TRY(read_whole_file(file_.path, 1 << 20, "bus.json"));
    // Where it cannot be written is known before anybody turns anything.
    if (options_.store) file_.out = KAZ_TRY(OutputFile::open(file_.path, "--robot-file"));
    servos_.emplace(bus.protocol, std::move(bus.port), clock_);
    KAZ_TRY(look());
    if (folder_) KAZ_TRY(folder_->clear());
    KAZ_TRY(sweep());
    plan();
    if (!options_.json) print();
    bool good = true;
    for (const RangePlan& one : plans_) good = good && one.fault.empty();
    if (good && options_.store) KAZ_TRY(store());
    const Json result = json();
    if (folder_) KAZ_TRY(folder_->write_json("result.json", result));
    if (options_.json) print_json(result);
    if (!good)
      std::fprintf(stderr, "%s: not all joints have a good range; nothing is written\n", kVerb);
    return ExitStatus(good);
  }

 private:
  std::vector<const BusServo*> all_servos() const {
    std::vector<const BusServo*> all;
    for (const BusJoint& joint : joints_) all.push_back(&joint.servo);
    return all;
  }

  // Each servo is there, of its model, without torque.
  Result<void> look() {
    const std::string model = servos_->protocol() == Protocol::feetech ? "model" : "model_number",
                      mode = servos_->protocol() == Protocol::feetech ? "mode" : "operating_mode";
    for (const BusJoint& joint : joints_) {
      const BusServo& servo = joint.servo;
      if (const int number = KAZ_TRY(servos_->read(servo, model)); number != servo.model->number)
        return fail(Fault::usage, named(servo) + " on " + servos_->port() + " has model number " +
                                      std::to_string(number) + ", but bus.json gives " +
                                      std::string(servo.model->name));
      if (servo.model->find(mode) != nullptr) {
        if (const int now = KAZ_TRY(servos_->read(servo, mode));
            now != servos_->driver().position_mode())
          return fail(Fault::usage, named(servo) + " on " + servos_->port() + " is in mode " +
                                        std::to_string(now) + ": set it to the position mode, " +
                                        std::to_string(servos_->driver().position_mode()));
      }
    }
    KAZ_TRY(require_limp(servos_->driver(), joints_, servos_->port(), options_.release));
    for (const BusJoint& joint : joints_)
      before_.push_back(KAZ_TRY(servos_->registers_of(joint.servo)));
    for (const BusJoint& joint : joints_) sweeps_.emplace_back(*joint.servo.model);
    return {};
  }

  double share(std::size_t j) const {
    return host::range_share(joints_[j].servo, joints_[j].lower_rad, joints_[j].upper_rad,
                             sweeps_[j]);
  }

  std::string note() const {
    std::string text;
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      if (share(j) >= kWhole) continue;
      char one[80];
      std::snprintf(one, sizeof one, "%s%s %.0f %%", text.empty() ? "" : ", ",
                    joints_[j].servo.joint.c_str(), 100 * share(j));
      text += one;
    }
    return text.empty() ? "all joints reached both stops" : text;
  }

  // Until each joint was at both stops and none goes further, or the time is over.
  Result<void> sweep() {
    if (!options_.json)
      std::fprintf(stderr,
                   "%s: the motors are off. Turn each joint slowly by hand from one stop to the "
                   "other, in any order; the measurement ends by itself\n",
                   kVerb);
    Progress progress(kVerb, options_.json);
    const auto all = all_servos();
    const Time begin = clock_.now(), end = begin + from_seconds(options_.seconds);
    std::vector<Time> heard(all.size(), begin);
    double widths = 0;
    Time grown = begin;
    for (Time next = begin; next < end; next += kPeriod) {
      KAZ_TRY(clock_.sleep_until(next));
      const auto states = KAZ_TRY(servos_->driver().read_all(all));
      next = std::max(next, clock_.now() - kPeriod);
      double sum = 0, shares = 0, least = 1;
      for (std::size_t j = 0; j < all.size(); ++j) {
        if (states[j]) {
          sweeps_[j].add(states[j]->steps);
          heard[j] = clock_.now();
        } else if (clock_.now() - heard[j] > kLost) {
          return servos_->silent(*all[j]);
        }
        sum += sweeps_[j].width();
        shares += share(j);
        least = std::min(least, share(j));
      }
      progress.update(shares / static_cast<double>(all.size()), note());
      if (sum > widths) {
        widths = sum;
        grown = clock_.now();
      }
      if (least >= kWhole && clock_.now() - grown > kSettled) break;
    }
    progress.done();
    return {};
  }

  void plan() {
    for (std::size_t j = 0; j < joints_.size(); ++j)
      plans_.push_back(host::plan_range(joints_[j].servo, joints_[j].lower_rad,
                                        joints_[j].upper_rad, before_[j], sweeps_[j]));
  }

  void print() const {
    std::printf("%-16s %3s %12s %6s %12s %16s\n", "joint", "id", "turned, deg", "wraps",
                "stops, steps", "zero, bus.json");
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      const BusServo& servo = joints_[j].servo;
      const RangePlan& plan = plans_[j];
      char stops[40] = "-", zero[60] = "-";
      if (plan.fault.empty()) {
        std::snprintf(stops, sizeof stops, "%.0f..%.0f", plan.low, plan.high);
        std::snprintf(zero, sizeof zero, "%.0f -> %.0f", servo.zero, plan.zero);
      }
      std::printf("%-16s %3d %12.0f %6s %12s %16s\n", servo.joint.c_str(), servo.id,
                  sweeps_[j].width() / servo.model->steps_per_rad() * kPerDegree,
                  plan.wrapped ? "yes" : "no", stops, zero);
      if (!plan.fault.empty()) print_lines("    %s: %s\n", servo.joint.c_str(), plan.fault.c_str());
    }
  }

  bool writes_eeprom() const {
    for (std::size_t j = 0; j < joints_.size(); ++j)
      if (!(plans_[j].registers == before_[j])) return true;
    return false;
  }

  // What will be written, and whether it may.
  Result<void> confirm() {
    FILE* to = options_.json ? stderr : stdout;
    std::fprintf(to, writes_eeprom() ? "to be written to EEPROM:\n" : "no changes in EEPROM\n");
    for (std::size_t j = 0; j < joints_.size(); ++j)
      for (const Change& one :
           changes_of(names_of(servos_->protocol()), before_[j], plans_[j].registers))
        std::fprintf(to, "  %-32s %-18s %6d -> %d\n", named(joints_[j].servo).c_str(), one.name,
                     one.before, one.after);
    std::fprintf(to, "the new zero positions are to be written to %s\n", file_.path.c_str());
    std::fflush(to);
    if (options_.yes) return {};
    const auto reply = KAZ_TRY(prompt_user("Press Enter to write, n to stop", interrupt_, kNobody));
    if (reply.empty() || reply == "y" || reply == "yes") return {};
    return fail(Fault::failed, "stopped; nothing is written");
  }

  // The position moves as published, or else the angles would be others than planned.
  Result<void> write_and_check(std::size_t j) {
    const BusServo& servo = joints_[j].servo;
    const double before = KAZ_TRY(servos_->position(servo));
    KAZ_TRY(servos_->write(servo, before_[j], plans_[j].registers));
    const double by = plans_[j].registers.offset - before_[j].offset;
    const double wanted = before + (servos_->protocol() == Protocol::feetech ? -by : by);
    double off = KAZ_TRY(servos_->position(servo)) - wanted;
    off -= servo.model->steps * std::round(off / servo.model->steps);
    if (by != 0 && std::abs(off) > kSags)
      return fail(Fault::environment,
                  named(servo) + " on " + servos_->port() +
                      " does not shift its position as documented: the position is " +
                      std::to_string(std::lround(off)) +
                      " steps off (docs/reference/servo-bus.md)");
    return {};
  }

  // As a whole: an interrupt waits for it, an error takes it back.
  Result<void> store() {
    KAZ_TRY(confirm());
    const host::CleanUp whole(interrupt_, std::chrono::seconds(20));
    leaves_behind("the servos' offsets may be half-written: run " + std::string(kVerb) + " again");
    std::map<std::string, double> zeros;
    Result<void> done;
    std::size_t written = 0;
    for (; written < joints_.size() && done; ++written) {
      zeros[joints_[written].servo.joint] = plans_[written].zero;
      done = write_and_check(written);
    }
    if (done) done = file_.out->write(servo_bus::with_zeros(file_.text, zeros));
    if (!done) {
      Result<void> back;
      for (std::size_t j = 0; j < written; ++j) {
        const auto now = servos_->registers_of(joints_[j].servo);
        back = together(back, now ? servos_->write(joints_[j].servo, *now, before_[j])
                                  : tl::unexpected(now.error()));
      }
      leaves_behind("");
      if (!back)
        return fail(Fault::environment,
                    done.error().message +
                        "; and the changes could not be undone: " + back.error().message);
      done.error().message += "; all changes are undone, nothing is written";
      return done;
    }
    leaves_behind("");
    stored_ = true;
    if (!options_.json)
      std::printf("written and verified; the zeros are in %s\n", file_.path.c_str());
    return {};
  }

  Json json() const {
    Json all{{"port", servos_->port()},
             {"protocol", servo_bus::name_of(servos_->protocol())},
             {"robot_file", options_.backend.robot_file},
             {"stored", stored_},
             {"joints", Json::array()}};
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      const BusServo& servo = joints_[j].servo;
      const RangePlan& plan = plans_[j];
      Json one{{"joint", servo.joint},
               {"id", servo.id},
               {"turned_rad", sweeps_[j].width() / servo.model->steps_per_rad()},
               {"range_rad", joints_[j].upper_rad - joints_[j].lower_rad},
               {"wrapped", plan.wrapped}};
      if (!plan.fault.empty()) {
        one["fault"] = plan.fault;
      } else {
        one["steps"] = {plan.low, plan.high};
        one["zero"] = {{"before", servo.zero}, {"after", plan.zero}};
        one["eeprom"] = Json::object();
        for (const Change& change :
             changes_of(names_of(servos_->protocol()), before_[j], plan.registers))
          one["eeprom"][change.name] = {{"before", change.before}, {"after", change.after}};
      }
      all["joints"].push_back(one);
    }
    all["provenance"] = provenance_json();
    return all;
  }

  const BusCalibrationOptions& options_;
  host::Interrupt interrupt_;
  host::WallClock clock_{&interrupt_};
  struct BusFile {
    std::string path, text;
    std::optional<OutputFile> out;
  };
  BusFile file_;
  std::optional<OutputFolder> folder_;
  std::optional<CalibratedServos> servos_;  // refers to the clock
  std::vector<BusJoint> joints_;
  std::vector<RangeRegisters> before_;
  std::vector<RangeSweep> sweeps_;
  std::vector<RangePlan> plans_;
  bool stored_ = false;
};

}  // namespace

Result<ExitStatus> calibrate_bus_joints(const BusCalibrationOptions& options) {
  return BusCalibration(options).run();
}

}  // namespace kaz::tools
