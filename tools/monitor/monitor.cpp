// `kaz monitor`: joints, supply, tick and link in a terminal, and keys to move the joints.
// SPDX-License-Identifier: Apache-2.0
#include "tools/monitor/monitor.h"
#include "sim/runtime/simulation/recording_tap.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "host/bus/bus_driver.h"
#include "host/bus/bus_port.h"
#include "host/link/port_link.h"
#include "host/link/wall_clock.h"
#include "host/robot/robot.h"
#include "shared/base/angle.hpp"
#include "sim/body/description/robot_model.h"
#include "tools/base/arguments.h"
#include "tools/base/interrupt_signals.h"
#include "tools/kept/kept_run.h"
#include "tools/monitor/board_view.h"
#include "tools/monitor/terminal.h"
#include "tools/run/backend.h"
#include "tools/run/line_recorder.h"
#include "tools/run/robot_joints.h"

namespace kaz::tools {
namespace {

constexpr Time kRound = std::chrono::milliseconds(50);
constexpr int kSlow = 10;                // rounds between questions after what changes slowly
constexpr double kSpeed = 30 * kDegree;  // rad/s, of what the keys move
// A shell over a slow line may stand still for as long; the board's longest.
constexpr Time kWatchdog = std::chrono::seconds(1);

struct Limits {
  double lower_rad, upper_rad;
  double rad_per_s = kSpeed;  // largest speed
};

// What is at the port.
struct Monitored {
  host::PortAddress port;
  std::vector<host::BusJoint> servos = {};  // empty: a board
  std::vector<std::string> names = kaz_joint_names();
  std::vector<Limits> limits = {};
};

// The board or servo bus at a port, and the connection to it.
class MonitoredBoard {
 public:
  MonitoredBoard(host::PortAddress port, std::vector<host::BusJoint> servos,
                 const MonitorOptions& options, host::Interrupt& interrupt)
      : port_(std::move(port)),
        servos_(std::move(servos)),
        address_(options.address),
        tap_(options.tap),
        interrupt_(interrupt),
        clock_(&interrupt) {}

  std::string port() const { return port_.name(); }
  // The robot's clock, which sends heartbeats while motors are on; without a robot, this machine's clock.
  host::Clock& clock() { return robot_ ? robot_->clock() : static_cast<host::Clock&>(clock_); }
  host::Robot* robot() { return robot_ ? &*robot_ : nullptr; }
  // Returns the message of PortLink::still_on(); empty without a connection.
  std::string still_on() const { return link_ ? link_->still_on() : ""; }

  Result<void> connect(const std::vector<std::string>& joint_names) {
    auto link = KAZ_TRY(host::open_port(port_, &interrupt_));
    if (!servos_.empty()) KAZ_TRY(check_limp(*link));
    if (!servos_.empty())
      link = KAZ_TRY(host::BusPort::open(std::move(link), servos_, &interrupt_));
    link_ = std::move(link);
    host::Link* line = link_.get();
    if (tap_ != nullptr) {
      if (!tapped_) tapped_ = KAZ_TRY(LineRecorder::create("", {}, clock_, tap_));
      line = tapped_->record(*link_, 0);
    }
    // Nothing of the board is changed by looking at it.
    auto robot = host::Robot::connect(*line, clock_,
                                      {.address = address_,
                                       .watchdog = Time::zero(),
                                       .reconnect = Time::zero(),
                                       .joint_names = joint_names});
    if (!robot) {
      link_.reset();
      return tl::unexpected(robot.error());
    }
    robot_.emplace(std::move(*robot));
    return {};
  }
  void disconnect() {
    robot_.reset();
    link_.reset();
  }

 private:
  // Opening a bus switches its torque off, and what was held falls: not by looking at it.
  Result<void> check_limp(host::Link& link) {
    if (looked_) return {};
    const auto driver = host::BusDriver::make(servos_.front().servo.model->protocol, link, clock_);
    for (const host::BusJoint& joint : servos_) {
      const auto torque = KAZ_TRY(driver->read(joint.servo, "torque_enable"));
      if (torque && *torque != 0)
        return fail(
            Fault::environment,
            "the torque of " + joint.servo.joint + " on " + port_.name() +
                " is on, and connecting the monitor to the bus switches all torques off: end the "
                "program that drives the servos; if no program drives them, hold the robot, "
                "and switch its power off and on");
    }
    looked_ = true;
    return {};
  }

  host::PortAddress port_;
  std::vector<host::BusJoint> servos_;  // empty: a board
  std::uint8_t address_;
  sim::MessageTap* tap_;
  host::Interrupt& interrupt_;
  host::WallClock clock_;
  std::unique_ptr<host::PortLink> link_;
  std::unique_ptr<LineRecorder> tapped_;  // of viewers
  std::optional<host::Robot> robot_;
  bool looked_ = false;  // check_limp() succeeded
};

// Rate of the rounds of requests.
class RoundRate {
 public:
  void begin() { since_ = Time::zero(); }
  void count() { ++rounds_; }
  // Returns the rounds per second since the last measurement; nullopt if this was less than 300 ms ago.
  std::optional<double> measure(Time now) {
    if (now - since_ <= std::chrono::milliseconds(300)) return std::nullopt;
    std::optional<double> rate;
    if (since_ > Time::zero()) rate = rounds_ / seconds(now - since_);
    since_ = now;
    rounds_ = 0;
    return rate;
  }

 private:
  Time since_{};
  int rounds_ = 0;
};

class Monitor {
 public:
  Monitor(Monitored monitored, const MonitorOptions& options, host::Interrupt& interrupt)
      : board_(std::move(monitored.port), std::move(monitored.servos), options, interrupt),
        limits_(std::move(monitored.limits)),
        interrupt_(interrupt) {
    view_.port = board_.port();
    view_.names = std::move(monitored.names);
    if (!options.watched_at.empty()) said_ = "watch the board at " + options.watched_at;
  }

  // Errors: the board is not there at the start. Later ones are shown, and the board is sought.
  Result<void> run() {
    if (auto connected = connect(); !connected) {
      if (interrupt_.requested()) return {};
      return tl::unexpected(with_earlier_notes(connected.error(), board_.port()));
    }
    if (!earlier_notes(board_.port()).empty())
      said_ = "an interrupted run left notes: press q to quit and print the notes";
    auto terminal = KAZ_TRY(Terminal::open());
    while (!interrupt_.requested()) {
      const Time begin = board_.clock().now();
      query();
      for (Key key = terminal.key(); key != Key::none; key = terminal.key()) {
        if (key == Key::quit) return leave();
        press(key);
      }
      terminal.show(lines(view_, selected_, said_, terminal.rows(), terminal.columns()));
      if (auto slept = board_.clock().sleep_until(begin + kRound);
          !slept && !interrupt_.requested())
        lost(slept.error());
    }
    return leave();
  }

 private:
  Result<void> connect() {
    KAZ_TRY(board_.connect(view_.names));
    watched_ = false;
    wanted_.reset();
    view_.build = std::to_string(robot().identity().build_id);
    round_ = 0;
    rate_.begin();
    return {};
  }

  // Only while the board is connected.
  host::Robot& robot() { return *board_.robot(); }

  void lost(const Error& error) {
    view_.there = false;
    view_.fault = error.message;
    board_.disconnect();
    next_try_ = board_.clock().now() + std::chrono::seconds(1);
  }

  void query() {
    if (!board_.robot()) {
      if (board_.clock().now() < next_try_) return;
      if (auto again = connect(); !again) return lost(again.error());
      said_ = "the board answers again";
    }
    if (auto done = read(); !done && !interrupt_.requested()) lost(done.error());
  }

  Result<void> read() {
    auto joints = KAZ_TRY(robot().joints(host::kAllJoints));
    const auto targets = KAZ_TRY(robot().read_targets());
    rate_.count();
    if (round_++ % kSlow == 0) {
      const auto health = KAZ_TRY(robot().health());
      const auto counts = KAZ_TRY(robot().board_statistics());
      view_.health = health;
      view_.counts = counts;
      view_.fault = health.shutdown.empty() ? "" : robot().describe_fault(health.status);
      // What line 1 says already would push what to do out of the line.
      if (const auto at = view_.fault.find("went off: "); at != std::string::npos)
        view_.fault.erase(0, at + std::string_view("went off: ").size());
      if (const auto rate = rate_.measure(board_.clock().now())) view_.rounds_per_s = *rate;
    }
    view_.joints = std::move(joints);
    wanted_ = wanted_.value_or(on()) & on();
    view_.targets = targets;
    view_.link = robot().statistics();
    view_.there = true;
    return {};
  }

  int joints() const { return static_cast<int>(view_.names.size()); }
  const std::string& selected_name() const {
    return view_.names[static_cast<std::size_t>(selected_)];
  }
  std::uint32_t there() const { return (std::uint32_t{1} << joints()) - 1; }
  std::uint32_t on() const {
    std::uint32_t mask = 0;
    for (const host::JointDetail& joint : view_.joints) {
      if (joint.flags & KZ_JOINT_ON) mask |= std::uint32_t{1} << joint.joint;
    }
    return mask;
  }

  // A joint that was switched off, but does not confirm it, is reported as on. It is not in this mask, so
  // that the next key does not switch it on again.
  Result<void> enable(std::uint32_t mask) {
    wanted_ = mask;
    leaves_behind("the motors on " + board_.port() + " may still be on: cut their power");
    // Motors go on only with a link watchdog that switches them off if this program stops.
    if (!watched_) {
      watched_ = true;  // also if the reply does not come any more
      KAZ_TRY(robot().heartbeat(kWatchdog, host::Reaction::limp));
    }
    return robot().enable(mask);
  }

  Result<void> shift(double by_rad) {
    const Limits limits = limits_[static_cast<std::size_t>(selected_)];
    if ((on() >> selected_ & 1U) == 0)
      return fail(Fault::usage, selected_name() + " is off: press e to switch it on");
    const double from = view_.targets[static_cast<std::size_t>(selected_)];
    const double to = std::clamp(from + by_rad, limits.lower_rad, limits.upper_rad);
    const host::JointTarget target{selected_, to};
    if (auto set =
            robot().set_targets({&target, 1}, from_seconds(std::abs(to - from) / limits.rad_per_s));
        !set)
      return set;
    // Shown until the next reading of the board, so that keys pressed quickly add up.
    view_.targets[static_cast<std::size_t>(selected_)] = to;
    char text[40];
    std::snprintf(text, sizeof text, " to %.1f degrees", to / kDegree);
    said_ = selected_name() + text;
    return {};
  }

  Result<void> act(Key key) {
    const std::uint32_t bit = std::uint32_t{1} << selected_;
    switch (key) {
      case Key::left:
        return shift(-1 * kDegree);
      case Key::right:
        return shift(1 * kDegree);
      case Key::page_left:
        return shift(-5 * kDegree);
      case Key::page_right:
        return shift(5 * kDegree);
      case Key::toggle:
        said_ = selected_name();
        said_ += (on() & bit) != 0 ? " is off" : " is on and holds its angle";
        return enable((on() & bit) != 0 ? wanted_.value_or(on()) & ~bit
                                        : wanted_.value_or(on()) | bit);
      case Key::all_on:
        said_ = "all joints are on and hold their angles";
        return enable(there());
      case Key::stop:
        said_ = "stopped: all motors are off";
        wanted_ = 0;
        return robot().stop();
      case Key::clear:
        said_ = on() != 0 ? "no shutdown was latched; motors stay on"
                          : "no shutdown is latched now; motors stay off";
        return robot().clear();
      default:
        return {};
    }
  }

  void press(Key key) {
    if (key == Key::up) selected_ = (selected_ + joints() - 1) % joints();
    if (key == Key::down) selected_ = (selected_ + 1) % joints();
    if (key == Key::up || key == Key::down) return;
    if (!board_.robot()) {
      said_ = "no board answers";
      return;
    }
    if (auto done = act(key); !done) said_ = done.error().message;
    round_ = 0;  // ask for all of it at once
  }

  Result<void> leave() {
    // What it switched on, and the watchdog; a board that it only looked at is left as it was.
    if (!watched_ && board_.still_on().empty()) return {};
    if (!board_.robot())
      return fail(Fault::environment,
                  "motors were switched on, and the board no longer answers on " + board_.port() +
                      ": cut their power");
    const host::CleanUp clean_up(interrupt_);
    const auto off = robot().disable_all();
    const kz_identify_reply& was = robot().identity();
    (void)robot().heartbeat(std::chrono::milliseconds(10) * was.watchdog_10ms,
                            static_cast<host::Reaction>(was.reaction));
    if (const std::string on = off ? "" : board_.still_on(); !on.empty())
      return fail(Fault::environment, board_.port() + ": " + on);
    if (off) leaves_behind("");
    return off;
  }

  MonitoredBoard board_;
  std::vector<Limits> limits_;
  host::Interrupt& interrupt_;
  BoardView view_;
  int selected_ = 0, round_ = 0;
  RoundRate rate_;
  bool watched_ = false;
  std::optional<std::uint32_t> wanted_;  // joints that are to be on; none: not read yet
  Time next_try_{};
  std::string said_ = "the monitor only reads until you press a key; e or E switches motors on";
};

// Errors (usage): the port, the robot's files.
Result<Monitored> find_monitored(const MonitorOptions& options) {
  Monitored found;
  if (names_servo_bus(options.port)) {
    if (options.robot_file.empty())
      return fail(Fault::usage,
                  options.port +
                      " needs --robot-file FILE: give the robot's URDF; bus.json must "
                      "be in the same folder as the URDF");
    BackendOptions robot;
    robot.robot = options.port;
    robot.robot_file = options.robot_file;
    auto bus = KAZ_TRY(servo_bus_of(robot));
    found.port = std::move(bus.address);
    found.servos = std::move(bus.joints);
    found.names.clear();
    for (const host::BusJoint& joint : found.servos) {
      found.names.push_back(joint.servo.joint);
      found.limits.push_back({joint.lower_rad, joint.upper_rad});
    }
    return found;
  }
  found.port = KAZ_TRY(parse_port(options.port));
  if (!options.robot_file.empty()) {
    const auto robot = KAZ_TRY(sim::load_robot(options.robot_file, {.body = false}));
    KAZ_TRY(other_joints(robot, options.robot_file));  // no more than a board has
    found.names.clear();
    for (const sim::RobotJoint& joint : robot.joints) {
      if (joint.follows) continue;
      found.names.push_back(joint.name);
      found.limits.push_back({joint.lower, joint.upper, std::min(joint.velocity, kSpeed)});
    }
  }
  if (found.limits.empty())
    for (const host::JointInfo& info : host::joint_table())
      found.limits.push_back({info.lower_rad, info.upper_rad});
  return found;
}

}  // namespace

Result<bool> monitor(const MonitorOptions& options) {
  auto found = KAZ_TRY(find_monitored(options));
  const std::string name = found.port.name();
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  KAZ_TRY(Monitor(std::move(found), options, interrupt).run());
  // After the screen is gone, which would cover them.
  for (const std::string& sentence : earlier_notes(name))
    std::fprintf(stderr, "kaz monitor: %s\n", sentence.c_str());
  return true;
}

}  // namespace kaz::tools
