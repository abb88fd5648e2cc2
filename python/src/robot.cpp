// The host's client of a servo board: in a Simulation, or at a port.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <map>

#include "host/link/interruptible.h"
#include "host/robot/robot.h"
#include "python/src/simulation.h"
#include "tools/lockstep/lockstep.h"
#include "tools/run/backend.h"

namespace kaz::python {
namespace {

using Joints = std::vector<JointKey>;

int joint_of(const JointKey& key) {
  if (const int* number = std::get_if<int>(&key)) {
    if (*number >= 0 && *number < KZ_JOINTS) return *number;
    raise({Fault::usage, "joint " + std::to_string(*number) + ": must be 0 to " +
                             std::to_string(KZ_JOINTS - 1) + ", or a name"});
  }
  const std::string& name = std::get<std::string>(key);
  if (const auto number = host::joint_index(name)) return *number;
  std::string names;
  for (const host::JointInfo& joint : host::joint_table())
    names += (names.empty() ? "" : ", ") + std::string(joint.name);
  raise({Fault::usage, "joint '" + name + "': must be one of " + names});
}

std::uint32_t mask_of(const std::optional<Joints>& joints) {
  if (!joints) return host::kAllJoints;
  std::uint32_t mask = 0;
  for (const JointKey& key : *joints) mask |= std::uint32_t{1} << joint_of(key);
  return mask;
}

Time time_of(const char* what, double seconds_, double most) {
  if (!(seconds_ >= 0 && seconds_ <= most))
    raise({Fault::usage,
           std::string(what) + ": must be 0 to " + std::to_string(static_cast<int>(most)) + " s"});
  return from_seconds(seconds_);
}

// A mapping from joints to angles, or an array of all 18.
using Targets = std::variant<std::map<JointKey, double>, std::vector<double>>;

std::vector<host::JointTarget> targets_of(const Targets& given) {
  std::vector<host::JointTarget> targets;
  const auto add = [&targets](int joint, double angle) {
    if (!std::isfinite(angle)) raise({Fault::usage, "targets: angles must be finite"});
    targets.push_back({joint, angle});
  };
  if (const auto* some = std::get_if<std::map<JointKey, double>>(&given)) {
    for (const auto& [key, angle] : *some) add(joint_of(key), angle);
  } else {
    const auto& all = std::get<std::vector<double>>(given);
    if (all.size() != KZ_JOINTS)
      raise({Fault::usage, "targets: give an angle for each of the " + std::to_string(KZ_JOINTS) +
                               " joints, or a dict of joints and angles"});
    for (std::size_t j = 0; j < all.size(); ++j) add(static_cast<int>(j), all[j]);
  }
  return targets;
}

// A robot, where its lines and clock come from, and its lock: of one in a Simulation the simulation's.
class PythonRobot {
 public:
  explicit PythonRobot(std::shared_ptr<SimulatedWorld> world, const host::ConnectOptions& options)
      : world_(std::move(world)), lock_(world_->lock()) {
    robot_.emplace(value_of(world_->alone([&](sim::Simulation& simulation) {
      simulated_.emplace(simulation, lock_.interrupt());
      return host::Robot::connect(simulated_->link, simulated_->clock, options);
    })));
  }
  PythonRobot(const std::string& port, const std::string& robot_file, std::uint8_t address,
              const host::ConnectOptions& options) {
    tools::BackendOptions backend;
    backend.robot = port;
    backend.robot_file = robot_file;
    backend.address = address;
    backend.needs_camera = false;
    if (port == "sim")
      raise({Fault::usage, "Robot('sim'): 'sim' is not a port; pass a Simulation"});
    port_ =
        value_of(released([&] { return tools::SessionBackend::open(backend, lock_.interrupt()); }));
    robot_.emplace(value_of(released([&] {
      const auto boards = port_->boards();
      return host::Robot::connect(boards, port_->clock(), options);
    })));
  }
  // As every program leaves it.
  ~PythonRobot() {
    if (!closed_) close_after_error();
  }
  PythonRobot(const PythonRobot&) = delete;
  PythonRobot& operator=(const PythonRobot&) = delete;

  // What `work` returns, a Result, for the robot.
  template <class F>
  auto alone(F work) {
    return value_of(LockedCall(lock_).piece([&] { return with_robot(work); }));
  }

  // From any thread, at any time: the running call ends, its requests are abandoned, and the stop is sent.
  void stop() {
    auto stopped = released([this] {
      const ObjectLock::Stop alone(lock_);
      return with_robot([](host::Robot& robot) { return robot.stop(); });
    });
    if (stopped) return;
    if (stopped.error().fault != Fault::usage)
      stopped.error().message += "; the motors may still be on: cut the power";
    raise(stopped.error());
  }
  // Raises if no reply confirms that the motors are off.
  void close() { value_of(switch_off()); }
  // Prints that instead: another exception is on its way, or nobody catches one.
  void close_after_error() {
    if (const auto off = switch_off(); !off)
      std::fprintf(stderr, "kaz: %s\n", off.error().message.c_str());
  }

  // Ctrl-C ends it; the motors stay on.
  void sleep(double seconds_) {
    const Time left = time_of("sleep: seconds", seconds_, 1e6);
    LockedCall call(lock_);
    std::optional<Time> until;
    const auto piece = [&](host::Robot& robot) -> Result<bool> {
      host::Clock& clock = robot.clock();
      if (!until) until = clock.now() + left;
      KAZ_TRY(clock.sleep_until(std::min(*until, clock.now() + kBetweenSignals)));
      return clock.now() >= *until;
    };
    while (!value_of(call.piece([&] { return with_robot(piece); }))) check_signals();
  }

 private:
  static constexpr Time kBetweenSignals = std::chrono::milliseconds(100);

  struct Simulated {
    Simulated(sim::Simulation& simulation, const host::Interrupt& interrupt)
        : raw_clock(simulation),
          raw_link(simulation),
          clock(raw_clock, interrupt),
          link(raw_link, raw_clock, interrupt) {}
    lockstep::LockstepClock raw_clock;
    lockstep::LockstepLink raw_link;
    host::InterruptibleClock clock;
    host::InterruptibleLink link;
  };

  Result<void> switch_off() {
    const py::gil_scoped_release release;
    const ObjectLock::Stop alone(lock_);
    if (closed_) return closed_as_;
    Result<void> off;
    std::string on;
    if (robot_) {
      off = robot_->disable_all();
      if (!port_) off = {};  // no motor has power in a simulation
      if (!off) on = port_->still_on();
    }
    robot_.reset();
    port_.reset();
    closed_ = true;
    if (!on.empty()) off = fail(Fault::environment, on);
    closed_as_ = off;
    return off;
  }

  template <class F>
  std::invoke_result_t<F, host::Robot&> with_robot(F work) {
    if (!robot_) return fail(Fault::usage, "this Robot is closed: create a new Robot");
    return work(*robot_);
  }

  const std::shared_ptr<SimulatedWorld> world_;
  ObjectLock own_lock_{"this Robot"};
  ObjectLock& lock_ = own_lock_;
  std::optional<Simulated> simulated_;
  std::unique_ptr<tools::SessionBackend> port_;
  std::optional<host::Robot> robot_;
  std::atomic<bool> closed_{false};
  Result<void> closed_as_;  // what the first close() found
};

host::ConnectOptions options_of(double watchdog, const std::string& reaction) {
  host::ConnectOptions options;
  if (!(watchdog >= 0.01 && watchdog <= 1)) raise({Fault::usage, "watchdog: must be 0.01 to 1 s"});
  options.watchdog = from_seconds(watchdog);
  options.reaction = named("when_lost", reaction, host::kReactions);
  return options;
}

py::dict joint_details(PythonRobot& self, const std::optional<Joints>& joints) {
  const std::uint32_t mask = mask_of(joints);
  const auto details = self.alone([&](host::Robot& robot) { return robot.joints(mask); });
  std::vector<std::string> names;
  std::vector<double> angle, speed, duty, load;
  for (const host::JointDetail& joint : details) {
    names.emplace_back(host::joint_table()[static_cast<std::size_t>(joint.joint)].name);
    angle.push_back(joint.angle_rad);
    speed.push_back(joint.speed_rad_per_s);
    duty.push_back(joint.duty);
    load.push_back(joint.load);
  }
  py::dict all;
  all["name"] = names;
  all["angle"] = array_of(angle);
  all["speed"] = array_of(speed);
  all["duty"] = array_of(duty);
  all["load"] = array_of(load);
  return all;
}

py::dict health_of(PythonRobot& self) {
  const host::Health health = self.alone([&](host::Robot& robot) { return robot.health(); });
  py::dict all;
  all["tick"] = health.tick;
  all["status"] = health.status;
  all["shutdown"] = health.shutdown;
  all["supply_volts"] = health.supply_volts;
  all["temperature_celsius"] = health.temperature_c;
  return all;
}

void add_joint_table(py::module_& module) {
  py::list names;
  py::dict limits;
  for (const host::JointInfo& joint : host::joint_table()) {
    names.append(joint.name);
    limits[joint.name] = py::make_tuple(joint.lower_rad, joint.upper_rad);
  }
  module.attr("JOINTS") = py::tuple(names);
  module.attr("JOINT_LIMITS") = limits;
}

void add_posture(py::module_& module) {
  py::class_<host::Posture>(module, "Posture")
      .def_property_readonly("time", [](const host::Posture& p) { return seconds(p.time); })
      .def_readonly("tick", &host::Posture::tick)
      .def_readonly("status", &host::Posture::status)
      .def_readonly("supply_volts", &host::Posture::supply_volts)
      .def_property_readonly("angle", [](const host::Posture& p) { return array_of(p.angle); });
}

}  // namespace

void add_robot(py::module_& module) {
  add_joint_table(module);
  add_posture(module);
  using Robot = PythonRobot;
  py::class_<Robot>(module, "Robot")
      .def(py::init([](std::shared_ptr<SimulatedWorld> world, double watchdog,
                       const std::string& when_lost) {
             return std::make_unique<Robot>(std::move(world), options_of(watchdog, when_lost));
           }),
           py::arg("simulation").none(false), py::kw_only(), py::arg("watchdog") = 0.09,
           py::arg("when_lost") = "hold")
      .def(py::init([](const std::string& port, const std::string& robot_file, int address,
                       double watchdog, const std::string& when_lost) {
             if (address < 1 || address > 14)
               raise({Fault::usage, "address " + std::to_string(address) + ": must be 1 to 14"});
             return std::make_unique<Robot>(port, robot_file, static_cast<std::uint8_t>(address),
                                            options_of(watchdog, when_lost));
           }),
           py::arg("port"), py::kw_only(), py::arg("robot_file") = "", py::arg("address") = 1,
           py::arg("watchdog") = 0.09, py::arg("when_lost") = "hold")
      .def(
          "enable",
          [](Robot& self, const std::optional<Joints>& joints) {
            const std::uint32_t mask = mask_of(joints);
            self.alone([&](host::Robot& robot) { return robot.enable(mask); });
          },
          py::arg("joints") = py::none())
      .def(
          "set_targets",
          [](Robot& self, const Targets& given, double duration) {
            const auto targets = targets_of(given);
            const Time time = time_of("duration", duration, 65);
            self.alone([&](host::Robot& robot) { return robot.set_targets(targets, time); });
          },
          py::arg("targets"), py::arg("duration") = 0.0)
      .def(
          "state",
          [](Robot& self) { return self.alone([&](host::Robot& robot) { return robot.state(); }); })
      .def(
          "exchange",
          [](Robot& self, const Targets& given, double duration) {
            const auto targets = targets_of(given);
            const Time time = time_of("duration", duration, 65);
            return self.alone([&](host::Robot& robot) { return robot.exchange(targets, time); });
          },
          py::arg("targets"), py::arg("duration") = 0.0)
      .def("joints", &joint_details, py::arg("joints") = py::none())
      .def("health", &health_of)
      .def(
          "set_gains",
          [](Robot& self, const std::optional<Joints>& joints, double kp, double kd,
             double dead_band, double friction) {
            const std::uint32_t mask = mask_of(joints);
            const host::Gains gains{kp, kd, dead_band, friction};
            self.alone([&](host::Robot& robot) { return robot.set_gains(mask, gains); });
          },
          py::arg("joints") = py::none(), py::kw_only(), py::arg("kp") = host::Gains{}.kp_per_rad,
          py::arg("kd") = host::Gains{}.kd_s_per_rad, py::arg("dead_band") = 0.0,
          py::arg("friction") = 0.0)
      .def(
          "set_limits",
          [](Robot& self, const std::optional<Joints>& joints, double ramp, double lower,
             double upper) {
            const std::uint32_t mask = mask_of(joints);
            const host::Limits limits_{ramp, lower, upper};
            self.alone([&](host::Robot& robot) { return robot.set_limits(mask, limits_); });
          },
          py::arg("joints") = py::none(), py::kw_only(),
          py::arg("ramp") = host::Limits{}.ramp_rad_per_s,
          py::arg("lower") = host::Limits{}.lower_rad, py::arg("upper") = host::Limits{}.upper_rad)
      // Not &Robot::stop: pybind11 would take self by pointer, so None would be null.
      .def(
          "stop", [](Robot& self) { self.stop(); },
          "Switches the motors off at once. Can be called from any thread. If another thread is in "
          "a call on this robot, the call of the other thread raises Stopped. Returns when the "
          "board has confirmed that the motors are off.")
      .def("clear",
           [](Robot& self) { self.alone([&](host::Robot& robot) { return robot.clear(); }); })
      .def(
          "sleep", [](Robot& self, double seconds_) { self.sleep(seconds_); }, py::arg("seconds"))
      .def_property_readonly("time",
                             [](Robot& self) {
                               return seconds(self.alone([](host::Robot& robot) -> Result<Time> {
                                 return robot.clock().now();
                               }));
                             })
      .def(
          "close", [](Robot& self) { self.close(); },
          "Switches the motors off and closes the port. Can be called from any thread, like "
          "stop().")
      .def(
          "__enter__", [](Robot& self) -> Robot& { return self; },
          py::return_value_policy::reference)
      .def("__exit__", [](Robot& self, const py::object& type, const py::args&) {
        type.is_none() ? self.close() : self.close_after_error();
      });
}

}  // namespace kaz::python
