// Records a servo that moves a pendulum.
// SPDX-License-Identifier: Apache-2.0
#include "hil/servo/pendulum_recorder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

namespace kaz::hil {
namespace {

using host::BusDriver;
using servo_bus::BusServo;
using servo_bus::Model;
using servo_bus::Protocol;
using servo_bus::Register;

constexpr Time kPeriod = std::chrono::milliseconds(10);
constexpr int kMostMissing = 5;                                // readings in a row
constexpr double kBeyond = 0.35;                               // rad, past the amplitude
constexpr double kFeetechAmps = 0.0065, kFeetechDuty = 0.166;  // A; duty for rad, of each unit of P
constexpr double kFastest = 30;                                // rad/s: no profile
constexpr double kBlend_s = 0.5;                               // from rest to the motion
constexpr double kStill = 0.01;                                // rad, within half a second
constexpr const char* kMayHold = "its torque is not confirmed to be off: cut its power";

struct Motion {
  const char* name;
  // -1..1 of the amplitude, at `u` seconds of six.
  double (*goal)(double u);
  bool drops;  // the torque goes off for the last third
};

double smooth(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

constexpr std::array kMotions{
    Motion{"wave",
           [](double u) { return 0.75 * std::sin(u) + 0.25 * std::sin(5 * u) * std::sin(2 * u); },
           false},
    Motion{"chirp", [](double u) { return 0.5 * std::sin(u * u / 3); }, false},
    Motion{"lift", [](double u) { return u < 3 ? smooth(u / 2.5) : 1 - 2 * smooth((u - 3) / 3); },
           false},
    Motion{"drop", [](double u) { return smooth(u / 2); }, true},
};

// What the law of a model is made of.
struct Law {
  const char* gain;
  std::vector<const char*> off;  // to 0
  double duty_per_rad;           // of each unit of the gain
  double most_duty;
  std::array<double, 3> shares;  // gains, of the one that it has; the middle one is held out
};

std::optional<Law> law_of(const Model& model) {
  if (model.name == "sts3215")
    return Law{"position_p",
               {"position_d", "position_i", "min_start_force", "acceleration"},
               kFeetechDuty,
               0.97,
               {0.25, 0.5, 1}};
  if (model.protocol != Protocol::dynamixel || model.position_p_unit == 0) return std::nullopt;
  constexpr double kFullPwm = 885;
  return Law{"position_p_gain",
             {"position_d_gain", "position_i_gain", "feedforward_1st_gain", "feedforward_2nd_gain",
              "profile_acceleration"},
             model.steps_per_rad() / model.position_p_unit / kFullPwm,
             1,
             {0.5, 1, 2}};
}

class Recorder {
 public:
  Recorder(host::Link& link, host::Clock& clock, const PendulumOptions& options)
      : link_(link),
        clock_(clock),
        options_(options),
        driver_(BusDriver::make(options.protocol, link, clock)) {}

  Result<PendulumRecord> run() {
    KAZ_TRY(find());
    auto recorded = record_all();
    // Whatever happened, also an interrupt: torque off, registers as they were.
    std::optional<host::CleanUp> clean_up;
    if (options_.interrupt != nullptr)
      clean_up.emplace(*options_.interrupt, std::chrono::milliseconds(4000));
    const auto left = leave();
    if (!recorded && !left)
      return fail(recorded.error().fault,
                  recorded.error().message + "; and " + left.error().message);
    if (!recorded) return tl::unexpected(recorded.error());
    KAZ_TRY(left);
    return record_;
  }

 private:
  std::string named() const { return "servo " + std::to_string(servo_.id) + " on " + link_.name(); }
  tl::unexpected<Error> wrong(Fault fault, const std::string& text) const {
    return fail(fault, named() + " " + text);
  }
  bool feetech() const { return options_.protocol == Protocol::feetech; }

  Result<int> read(std::string_view name) {
    const auto value = KAZ_TRY(driver_->read(servo_, name));
    if (!value)
      return wrong(
          Fault::environment,
          "does not answer: check its supply, plug, id and rate; `kaz bus scan` finds servos");
    return *value;
  }

  // Acknowledged, and read back.
  Result<void> set(std::string_view name, int value) {
    for (int tries = 0; tries < 3; ++tries) {
      (void)KAZ_TRY(driver_->write(servo_, name, value));
      if (KAZ_TRY(driver_->read(servo_, name)) == value) return {};
    }
    return wrong(Fault::environment, "does not accept " + std::to_string(value) +
                                         " for its register " + std::string(name));
  }

  Result<void> find() {
    servo_.joint = "shaft";
    servo_.id = options_.id;
    const char* number = feetech() ? "model" : "model_number";
    for (const Model& model : servo_bus::models()) {
      if (model.protocol != options_.protocol) continue;
      servo_.model = &model;
      if (KAZ_TRY(read(number)) == model.number) break;
      servo_.model = nullptr;
    }
    if (servo_.model == nullptr) return wrong(Fault::usage, "is a model without a register table");
    const auto law = law_of(*servo_.model);
    if (!law)
      return wrong(Fault::usage, "is an " + std::string(servo_.model->name) +
                                     ": Kaz needs the servo's control law to compute the duty for "
                                     "the log, but the control law of this model is not "
                                     "published");
    law_ = *law;
    record_.servo = std::string(servo_.model->name) + ", id " + std::to_string(servo_.id);
    if (KAZ_TRY(read("torque_enable")) != 0)
      return wrong(
          Fault::usage,
          "has its torque on: end the program that drives it. If `kaz bench pendulum` was killed, "
          "switch the servo's power off and on: the restart switches the torque off and "
          "restores the gains");
    if (KAZ_TRY(read(feetech() ? "mode" : "operating_mode")) != driver_->position_mode())
      return wrong(Fault::usage, "is not in position mode: switch it to that mode");
    if (feetech() && KAZ_TRY(read("lock")) == 0)
      return wrong(Fault::usage,
                   "has an unlocked EEPROM, so the changed gains would remain after power-off: "
                   "write 1 to its register `lock`");
    return {};
  }

  // From present_pwm or present_position to the temperature.
  struct Reading {
    double at_s = 0, angle = 0, amps = 0, volts = 0;
    std::optional<double> target;  // angle at which the servo's profile is
    int errors = 0;
  };
  Result<std::optional<Reading>> look() {
    const Model& model = *servo_.model;
    const Register &first = *model.find("present_position"),
                   *current = model.find("present_current"),
                   &volts = *model.find(feetech() ? "present_voltage" : "present_input_voltage"),
                   &celsius = *model.find("present_temperature"), *status = model.find("status");
    // DYNAMIXEL has the current before the position, Feetech behind it.
    const Register& begin =
        current != nullptr && current->address < first.address ? *current : first;
    const int end = current != nullptr ? std::max(current->end(), celsius.end()) : celsius.end();
    const Time sent = clock_.now();
    const auto bytes = KAZ_TRY(
        driver_->read_block(servo_, begin.name, static_cast<std::size_t>(end - begin.address)));
    if (!bytes) return std::optional<Reading>();
    const auto get = [&](const Register& reg) {
      return servo_bus::decode(
          model, reg,
          std::span(*bytes).subspan(static_cast<std::size_t>(reg.address - begin.address),
                                    reg.size));
    };
    Reading now;
    now.at_s = seconds((sent + clock_.now()) / 2);
    now.angle = servo_.angle_at(get(first));
    now.volts = get(volts) / 10.0;
    if (current != nullptr)
      now.amps = get(*current) * (feetech() ? kFeetechAmps : model.current_unit_a);
    if (status != nullptr) now.errors = get(*status);
    if (const Register* target = model.find("present_target"))
      now.target = servo_.angle_at(get(*target));
    record_.celsius = std::max(record_.celsius, static_cast<double>(get(celsius)));
    record_.volts = record_.volts == 0 ? now.volts : std::min(record_.volts, now.volts);
    record_.largest_amps = std::max(record_.largest_amps, std::abs(now.amps));
    return std::optional(now);
  }

  // Whether anything is as it should not be.
  Result<void> judge(const Reading& now) {
    char text[160];
    if (now.errors != 0) {
      std::snprintf(text, sizeof text,
                    "reports an error (status %d): the weight is too heavy, the servo is too hot, "
                    "or its voltage is wrong",
                    now.errors);
      return wrong(Fault::environment, text);
    }
    if (record_.celsius > options_.max_celsius) {
      std::snprintf(
          text, sizeof text,
          "is too hot: it is at %.0f degC, and the limit is %.0f degC; let the servo cool",
          record_.celsius, options_.max_celsius);
      return wrong(Fault::environment, text);
    }
    if (std::abs(now.amps) > options_.max_amps) {
      std::snprintf(text, sizeof text,
                    "draws too much current: %.2f A, and the limit is %.2f A; use a lighter weight",
                    now.amps, options_.max_amps);
      return wrong(Fault::environment, text);
    }
    if (std::abs(now.angle) > options_.amplitude_rad + kBeyond) {
      std::snprintf(
          text, sizeof text,
          "is at %.2f rad, beyond the amplitude of %.2f rad: the gain or the weight is too large",
          now.angle, options_.amplitude_rad);
      return wrong(Fault::environment, text);
    }
    return {};
  }

  // Waits until it hangs still, without torque.
  Result<double> rest() {
    constexpr Time kLongest = std::chrono::seconds(15), kLook = std::chrono::milliseconds(50);
    double low = 0, high = 0;
    int still = 0;
    for (const Time end = clock_.now() + kLongest; clock_.now() < end;) {
      const auto now = KAZ_TRY(look());
      if (now) {
        if (now->errors != 0) KAZ_TRY(judge(*now));
        low = still == 0 ? now->angle : std::min(low, now->angle);
        high = still == 0 ? now->angle : std::max(high, now->angle);
        still = high - low < kStill ? still + 1 : 0;
        if (still >= 10) return (low + high) / 2;
      }
      KAZ_TRY(clock_.sleep_until(clock_.now() + kLook));
    }
    return wrong(Fault::environment, "does not come to rest within 15 s, or does not answer");
  }

  // The middle of the log is where it hangs; the amplitude has to have room about it.
  Result<void> place() {
    servo_.zero = 0;
    const double steps = KAZ_TRY(rest()) * servo_.model->steps_per_rad();
    servo_.zero = std::round(steps);
    const double reach = (options_.amplitude_rad + kBeyond) * servo_.model->steps_per_rad();
    const int low = KAZ_TRY(read(feetech() ? "min_angle" : "min_position_limit")),
              high = KAZ_TRY(read(feetech() ? "max_angle" : "max_position_limit"));
    const bool none = feetech() && low == 0 && high == 0;
    const double from = none ? 0 : std::max(low, 0),
                 to = none ? servo_.model->steps - 1 : std::min(high, servo_.model->steps - 1);
    if (servo_.zero - reach < from || servo_.zero + reach > to) {
      char text[200];
      std::snprintf(text, sizeof text,
                    "rests at step %.0f and swings %.0f steps to each side, but its range is steps "
                    "%.0f to %.0f: put the horn on again, with the arm near the middle of the "
                    "range, or reduce --amplitude",
                    servo_.zero, reach, from, to);
      return wrong(Fault::usage, text);
    }
    return {};
  }

  Result<void> keep(const char* name) {
    if (servo_.model->find(name) == nullptr) return {};
    before_.emplace_back(name, KAZ_TRY(read(name)));
    return {};
  }

  Result<PendulumRecord> record_all() {
    KAZ_TRY(place());
    KAZ_TRY(keep(law_.gain));
    const int gain = before_.front().second;
    for (const char* name : law_.off) KAZ_TRY(keep(name));
    for (const char* name : {"profile_velocity", "goal_speed"}) KAZ_TRY(keep(name));
    for (const char* name : law_.off)
      if (servo_.model->find(name) != nullptr) KAZ_TRY(set(name, 0));
    const double all = static_cast<double>(law_.shares.size() * kMotions.size());
    for (std::size_t g = 0; g < law_.shares.size(); ++g) {
      const Register& reg = *servo_.model->find(law_.gain);
      const int p = std::clamp(static_cast<int>(std::lround(law_.shares[g] * gain)), 1, reg.max);
      KAZ_TRY(set(law_.gain, p));
      for (const Motion& motion : kMotions) {
        PendulumLog one;
        one.held_out = g == 1;
        one.name = std::string(one.held_out ? "held" : "fit") + "-p" + std::to_string(p) + "-" +
                   motion.name;
        done_ = static_cast<double>(record_.logs.size()) / all;
        one.log.name = one.name;
        one.log.gain_per_rad = law_.duty_per_rad * p;
        KAZ_TRY(record(motion, one, all));
        record_.logs.push_back(std::move(one));
      }
    }
    return record_;
  }

  // An STS goes to each goal on a profile, whatever its settings, and its loop follows that. Tables disagree
  // on the register where it stands: it is believed where it is the goal that was just reached.
  Result<bool> has_target(double goal) {
    const auto now = KAZ_TRY(look());
    constexpr double kSteps = 4;
    return now && now->target &&
           std::abs(*now->target - goal) * servo_.model->steps_per_rad() <= kSteps;
  }

  Result<void> goal_at(double angle) {
    const BusDriver::Goal goal{&servo_, servo_.steps_at(angle),
                               kFastest * servo_.model->steps_per_rad()};
    return driver_->move(std::span(&goal, 1));
  }

  Result<void> record(const Motion& motion, PendulumLog& one, double all) {
    one.log.mass_kg = options_.mass_kg;
    one.log.length_m = options_.length_m;
    one.log.arm_kg = options_.arm_kg;
    one.log.most_duty = law_.most_duty;
    one.log.has_current = servo_.model->find("present_current") != nullptr;
    // Friction may hold it some degrees from where it would hang: from there without a jump.
    const double start = KAZ_TRY(rest());
    torque_ = true;
    if (!KAZ_TRY(driver_->hold(servo_, servo_.steps_at(start))))
      return wrong(Fault::environment, "does not switch its torque on");
    one.follows_profile = KAZ_TRY(has_target(start));
    const Time begin = clock_.now();
    const double drop_s = motion.drops ? options_.seconds * 2 / 3 : 2 * options_.seconds;
    int silent = 0;
    for (Time next = begin;; next = std::max(next + kPeriod, clock_.now() - kPeriod)) {
      KAZ_TRY(clock_.sleep_until(next));
      const double t = seconds(clock_.now() - begin);
      if (t > options_.seconds) break;
      const double goal = start * (1 - smooth(t / kBlend_s)) +
                          options_.amplitude_rad * motion.goal(t * 6 / options_.seconds);
      if (t >= drop_s && torque_) {
        KAZ_TRY(release());
      }
      if (torque_) KAZ_TRY(goal_at(goal));
      const auto now = KAZ_TRY(look());
      if (!now) {
        ++one.missing;
        if (++silent >= kMostMissing)
          return wrong(Fault::environment, "no longer answers: check its plug and supply");
        continue;
      }
      silent = 0;
      KAZ_TRY(judge(*now));
      const double wanted = one.follows_profile ? now->target.value_or(goal) : goal;
      one.log.samples.push_back(
          {now->at_s - seconds(begin), wanted, now->angle, now->volts, now->amps, torque_});
      if (options_.progress) options_.progress(done_ + t / options_.seconds / all, one.name);
    }
    return release();
  }

  // Fails unless the servo says that its torque is off.
  Result<void> release() {
    const BusServo* const servo = &servo_;
    const auto torque = driver_->release({&servo, 1});
    if (torque && torque->front() == BusDriver::Torque::off) {
      torque_ = false;
      return {};
    }
    return wrong(torque ? Fault::environment : torque.error().fault,
                 std::string("may still hold the arm, because ") + kMayHold +
                     (torque ? "" : " (" + torque.error().message + ")"));
  }

  Result<void> leave() {
    std::string left;
    auto off = release();
    for (int tries = 0; tries < 5 && !off; ++tries) off = release();
    for (const auto& [name, value] : before_) {
      if (set(name, value)) continue;
      left += (left.empty() ? "registers not restored: " : ", ") + std::string(name) + " was " +
              std::to_string(value);
    }
    if (!off) left = kMayHold + (left.empty() ? "" : "; " + left);
    if (left.empty()) return {};
    return wrong(Fault::environment, "was left in a changed state: " + left);
  }

  host::Link& link_;
  host::Clock& clock_;
  const PendulumOptions& options_;
  std::unique_ptr<BusDriver> driver_;
  BusServo servo_;
  Law law_{};
  std::vector<std::pair<const char*, int>> before_;
  PendulumRecord record_;
  double done_ = 0;
  bool torque_ = false;
};

}  // namespace

Result<PendulumRecord> record_pendulum(host::Link& link, host::Clock& clock,
                                       const PendulumOptions& options) {
  return Recorder(link, clock, options).run();
}

}  // namespace kaz::hil
