// A motion by hand, as poses.
// SPDX-License-Identifier: Apache-2.0
#include "tools/bus/record_motion.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include <nlohmann/json.hpp>

#include "host/bus/bus_driver.h"
#include "host/link/wall_clock.h"
#include "host/motion/pose_sequence.h"
#include "shared/base/angle.hpp"
#include "shared/base/counted.hpp"
#include "tools/base/arguments.h"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/base/output_file.h"
#include "tools/base/provenance.h"
#include "tools/run/backend.h"

namespace kaz::tools {
namespace {

using host::BusDriver;
using host::BusJoint;
using Json = nlohmann::ordered_json;

constexpr const char* kVerb = "kaz bus record";
constexpr Time kPeriod = std::chrono::milliseconds(20), kLost = std::chrono::seconds(2);
constexpr double kMoved = 2 * kDegree;   // by which a motion begins and ends
constexpr double kBeyond = 3 * kDegree;  // of its limits, where a stop gives way
constexpr double kPoseEvery_s = 0.15;    // and the poses are means over a third of it
constexpr double kFastest = 4;           // rad/s, of what is played
constexpr std::size_t kMostPoses = 900;

struct Sample {
  double at_s;
  std::vector<double> angles;
};

std::vector<const servo_bus::BusServo*> servos_of(const std::vector<BusJoint>& joints) {
  std::vector<const servo_bus::BusServo*> all;
  for (const BusJoint& joint : joints) all.push_back(&joint.servo);
  return all;
}

class Recording {
 public:
  explicit Recording(const MotionRecordOptions& options) : options_(options) {}

  Result<ExitStatus> run() {
    const InterruptSignals signals(interrupt_);
    auto file = KAZ_TRY(OutputFile::open(options_.out, "--out"));
    auto bus = KAZ_TRY(open_servo_bus(options_.backend, interrupt_));
    port_ = std::move(bus.port);
    joints_ = std::move(bus.joints);
    driver_ = BusDriver::make(bus.protocol, *port_, clock_);
    KAZ_TRY(require_limp(*driver_, joints_, port_->name(), options_.release));
    KAZ_TRY(read());
    const auto problem = trim();
    if (!problem.empty()) {
      std::fprintf(stderr, "%s: %s; nothing is written\n", kVerb, problem.c_str());
      return ExitStatus(false);
    }
    auto sequence = poses();
    const double stretched = stretch(sequence);
    KAZ_TRY(file.write(motion::text_of(sequence) + "\n"));
    return report(sequence, stretched);
  }

 private:
  Result<void> read() {
    if (!options_.json)
      std::fprintf(stderr, "%s: the motors are off; move the robot by hand for %.0f s\n", kVerb,
                   options_.seconds);
    Progress progress(kVerb, options_.json);
    const auto servos = servos_of(joints_);
    const Time begin = clock_.now(), end = begin + from_seconds(options_.seconds);
    std::vector<Time> heard(joints_.size(), begin);
    std::vector<double> last(joints_.size(), NAN);
    for (Time next = begin; next < end; next = std::max(next + kPeriod, clock_.now() - kPeriod)) {
      KAZ_TRY(clock_.sleep_until(next));
      const auto states = KAZ_TRY(driver_->read_all(servos));
      const Time now = clock_.now();
      for (std::size_t j = 0; j < joints_.size(); ++j) {
        if (states[j]) {
          last[j] = joints_[j].servo.angle_at(states[j]->steps);
          heard[j] = now;
        } else if (now - heard[j] > kLost) {
          return tl::unexpected(silent_servo(joints_[j].servo, port_->name()));
        }
      }
      if (std::ranges::none_of(last, [](double angle) { return std::isnan(angle); }))
        samples_.push_back({seconds(now - begin), last});
      progress.update(seconds(now - begin) / options_.seconds, "");
    }
    progress.done();
    return {};
  }

  // From where something moves to where nothing does any more. Returns what is wrong with it.
  std::string trim() {
    if (samples_.empty()) return "no complete reading of all joints was received";
    const auto differs = [](const Sample& a, const Sample& b) {
      for (std::size_t j = 0; j < a.angles.size(); ++j)
        if (std::abs(a.angles[j] - b.angles[j]) > kMoved) return true;
      return false;
    };
    std::size_t first = 0, last = samples_.size() - 1;
    while (first < last && !differs(samples_[first], samples_.front())) ++first;
    while (last > first && !differs(samples_[last], samples_.back())) --last;
    if (first >= last) return "no joint was moved";
    constexpr std::size_t kAround = 10;  // samples of rest at both ends
    first -= std::min(first, kAround);
    last = std::min(last + kAround, samples_.size() - 1);
    samples_ = {samples_.begin() + static_cast<std::ptrdiff_t>(first),
                samples_.begin() + static_cast<std::ptrdiff_t>(last) + 1};
    for (Sample& sample : samples_) {
      for (std::size_t j = 0; j < joints_.size(); ++j) {
        const BusJoint& joint = joints_[j];
        double& angle = sample.angles[j];
        if (angle < joint.lower_rad - kBeyond || angle > joint.upper_rad + kBeyond) {
          char text[240];
          std::snprintf(text, sizeof text,
                        "%s was at %.0f degrees, but its limits are %.0f to %.0f: set the joint's "
                        "zero with `kaz calibrate joints`",
                        joint.servo.joint.c_str(), angle / kDegree, joint.lower_rad / kDegree,
                        joint.upper_rad / kDegree);
          return text;
        }
        angle = std::clamp(angle, joint.lower_rad, joint.upper_rad);
      }
    }
    return "";
  }

  double mean(double at_s, double half_s, std::size_t j) const {
    double sum = 0;
    int count = 0;
    const Sample* nearest = &samples_.front();
    for (const Sample& one : samples_) {
      if (std::abs(one.at_s - at_s) < std::abs(nearest->at_s - at_s)) nearest = &one;
      if (std::abs(one.at_s - at_s) > half_s) continue;
      sum += one.angles[j];
      ++count;
    }
    return count > 0 ? sum / count : nearest->angles[j];
  }

  motion::PoseSequence poses() const {
    const double begin = samples_.front().at_s, length = samples_.back().at_s - begin;
    const double every = std::max(kPoseEvery_s, length / static_cast<double>(kMostPoses));
    motion::PoseSequence sequence;
    for (double t = 0; t < length + every; t += every) {
      const double at = std::min(t, length);
      motion::Pose& pose = sequence.poses.emplace_back();
      pose.time_s = std::round(1e3 * at) / 1e3;
      for (std::size_t j = 0; j < joints_.size(); ++j)
        pose.angles_rad.emplace_back(
            joints_[j].servo.joint,
            std::round(1e4 * std::clamp(mean(begin + at, every / 3, j), joints_[j].lower_rad,
                                        joints_[j].upper_rad)) /
                1e4);
      if (at >= length) break;
    }
    if (sequence.poses.size() > 1 &&
        sequence.poses.back().time_s <= sequence.poses[sequence.poses.size() - 2].time_s)
      sequence.poses.pop_back();
    return sequence;
  }

  // A hand may be faster than a servo. Returns by how much the times grew.
  static double stretch(motion::PoseSequence& sequence) {
    double fastest = 0;
    for (std::size_t i = 1; i < sequence.poses.size(); ++i) {
      const auto &a = sequence.poses[i - 1], &b = sequence.poses[i];
      for (std::size_t j = 0; j < b.angles_rad.size(); ++j)
        fastest = std::max(fastest, std::abs(b.angles_rad[j].second - a.angles_rad[j].second) /
                                        (b.time_s - a.time_s));
    }
    // Between poses a cubic is faster than its chord, at most three halves.
    const double factor = std::max(1.0, 1.5 * fastest / kFastest);
    for (motion::Pose& pose : sequence.poses)
      pose.time_s = std::round(1e3 * factor * pose.time_s) / 1e3;
    return factor;
  }

  ExitStatus report(const motion::PoseSequence& sequence, double stretched) const {
    const double length = sequence.poses.back().time_s;
    if (options_.json) {
      print_json({{"file", options_.out},
                  {"poses", sequence.poses.size()},
                  {"seconds", length},
                  {"stretched", stretched},
                  {"requests", driver_->counts().requests},
                  {"missing", driver_->counts().missing},
                  {"damaged", driver_->counts().damaged},
                  {"provenance", provenance_json()}});
      return {};
    }
    std::printf(
        "%s, %.1f s, in %s%s\n", counted(sequence.poses.size(), "pose").c_str(), length,
        options_.out.c_str(),
        stretched > 1 ? "; the motion was slowed down to at most 4 rad/s" : "");
    print_lines("play the poses: kaz run play --poses %s --robot %s --robot-file %s\n",
                options_.out.c_str(), options_.backend.robot.c_str(),
                options_.backend.robot_file.c_str());
    return {};
  }

  const MotionRecordOptions& options_;
  host::Interrupt interrupt_;
  host::WallClock clock_{&interrupt_};
  std::unique_ptr<host::PortLink> port_;
  std::unique_ptr<BusDriver> driver_;  // refers to the port
  std::vector<BusJoint> joints_;
  std::vector<Sample> samples_;
};

std::string trouble_text(std::uint8_t trouble) {
  std::string text;
  for (const auto& [bit, what] : {std::pair(host::kTroubleVoltage, "voltage"),
                                  {host::kTroubleSensor, "sensor"},
                                  {host::kTroubleHeat, "heat"},
                                  {host::kTroubleOverload, "overload"}})
    if ((trouble & bit) != 0) text += (text.empty() ? "" : ", ") + std::string(what);
  return text;
}

}  // namespace

Result<ExitStatus> record_motion(const MotionRecordOptions& options) {
  return Recording(options).run();
}

Result<ExitStatus> print_bus_status(const BusStatusOptions& options) {
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  const auto bus = KAZ_TRY(open_servo_bus(options.backend, interrupt));
  host::WallClock clock(&interrupt);
  const auto driver = BusDriver::make(bus.protocol, *bus.port, clock);
  const auto states = KAZ_TRY(driver->read_all(servos_of(bus.joints)));
  constexpr double kFeetechAmps = 0.0065;
  bool good = true;
  Json all{{"port", bus.port->name()}, {"servos", Json::array()}};
  for (std::size_t j = 0; j < bus.joints.size(); ++j) {
    const servo_bus::BusServo& servo = bus.joints[j].servo;
    Json one{{"joint", servo.joint}, {"id", servo.id}, {"answers", states[j].has_value()}};
    good = good && states[j] && states[j]->trouble == 0;
    if (states[j]) {
      const host::ServoState& state = *states[j];
      one["position"] = state.steps;
      one["angle_deg"] = std::round(10 * servo.angle_at(state.steps) / kDegree) / 10;
      one["torque"] = KAZ_TRY(driver->read(servo, "torque_enable")).value_or(0) != 0;
      one["duty"] = std::round(1000 * servo.sign() * state.duty) / 1000;
      if (servo.model->find("present_current") != nullptr) {
        const double unit = bus.protocol == servo_bus::Protocol::feetech
                                ? kFeetechAmps
                                : servo.model->current_unit_a;
        if (const auto current = KAZ_TRY(driver->read(servo, "present_current")))
          one["amps"] = std::round(1000 * unit * *current) / 1000;
      }
      if (std::isfinite(state.volts)) one["volts"] = state.volts;
      if (std::isfinite(state.celsius)) one["celsius"] = state.celsius;
      one["errors"] = trouble_text(state.trouble);
    }
    all["servos"].push_back(one);
  }
  all["ok"] = good;
  all["requests"] = driver->counts().requests;
  all["missing"] = driver->counts().missing;
  all["damaged"] = driver->counts().damaged;
  if (options.json) {
    all["provenance"] = provenance_json();
    print_json(all);
    return ExitStatus(good);
  }
  std::printf("%-16s %3s %8s %9s %6s %6s %6s %5s %4s  %s\n", "joint", "id", "degrees", "position",
              "torque", "duty", "A", "V", "degC", "errors");
  for (const Json& one : all["servos"]) {
    if (!one["answers"].get<bool>()) {
      std::printf("%-16s %3d  does not answer\n", one["joint"].get<std::string>().c_str(),
                  one["id"].get<int>());
      continue;
    }
    std::printf("%-16s %3d %8.1f %9.0f %6s %6.2f %6.2f %5.1f %4.0f  %s\n",
                one["joint"].get<std::string>().c_str(), one["id"].get<int>(),
                one["angle_deg"].get<double>(), one["position"].get<double>(),
                one["torque"].get<bool>() ? "on" : "off", one["duty"].get<double>(),
                one.value("amps", NAN), one.value("volts", NAN), one.value("celsius", NAN),
                one["errors"].get<std::string>().c_str());
  }
  std::printf("%s, %d without an answer, %d damaged answers\n",
              counted(all["requests"].get<int>(), "request").c_str(), all["missing"].get<int>(),
              all["damaged"].get<int>());
  return ExitStatus(good);
}

}  // namespace kaz::tools
