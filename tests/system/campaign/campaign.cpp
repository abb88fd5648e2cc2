// Runs the rounds of the campaign, injects the events and checks the reactions.
// SPDX-License-Identifier: Apache-2.0
#include "tests/system/campaign/campaign.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "host/robot/robot.h"
#include "shared/base/random.hpp"
#include "shared/board/table.h"
#include "tests/studies/common/table.h"
#include "tests/system/campaign/line.h"
#include "tests/system/campaign/servo_view.h"

namespace kaz::campaign {
namespace {

using sim::States;
using std::chrono::milliseconds;

constexpr double kReactionDue_ms = 100;
constexpr double kSwitchOffDue_ms =
    2;  // after a reset or a power cut: at once, seen each millisecond
constexpr double kResumeDue_ms = 1000;
constexpr int kRoundsAWorld = 20;  // after a reaction `limp` the robot lies on the floor
constexpr Time kCycle = milliseconds(10), kRamp = milliseconds(12);

enum class Event { cable, port, garbage, host_killed, reset, power };
constexpr const char* kEventNames[] = {"cable pulled", "port gone", "garbage",
                                       "host killed",  "reset",     "power cut"};

bool is_link_event(Event event) {
  return event != Event::reset && event != Event::power;
}

double milliseconds_of(States states) {
  return 1e3 * static_cast<double>(states) / KZ_CLOCK_HZ;
}

// Observes the firmware in a round, each millisecond.
class Judge {
 public:
  Judge(CuttableLine& line, Event event, host::Reaction reaction)
      : line_(line),
        event_(event),
        reaction_(reaction),
        enabled_(servo_state(line.mcu()).enabled) {}

  // The event begins. Until it is over the motors must become and stay safe.
  void lost(States since) {
    since_ = since;
    watching_ = true;
  }
  void over() { watching_ = false; }

  // After each millisecond.
  void check() {
    if (!watching_) return;
    const ServoState now = servo_state(line_.mcu());
    const bool safe = holds() ? now.holding : !line_.simulation().board().drivers_enabled();
    if (safe && !safe_at_) {
      safe_at_ = line_.simulation().now();
      held_ = now;
    }
    if (!safe && safe_at_) unsafe_again_ = true;
    if (!holds() || !safe) return;
    for (std::size_t j = 0; j < KZ_JOINTS; ++j)
      creep_ = std::max(creep_, std::abs(now.command[j] - held_.command[j]));
  }

  // After each tick of the firmware: a joint that it has switched on has its angle as command.
  void tick() {
    const ServoState now = servo_state(line_.mcu());
    const std::uint32_t switched_on = now.enabled & ~enabled_;
    for (std::size_t j = 0; j < KZ_JOINTS; ++j)
      if (switched_on >> j & 1) jump_ = std::max(jump_, std::abs(now.command[j] - now.angle[j]));
    enabled_ = now.enabled;
  }

  std::optional<double> reaction_ms() const {
    if (!safe_at_) return std::nullopt;
    return std::max(0.0, milliseconds_of(*safe_at_ - since_));
  }
  double jump_mrad() const { return jump_ / 10.0; }
  double creep_mrad() const { return creep_ / 10.0; }
  bool unsafe_again() const { return unsafe_again_; }

 private:
  bool holds() const { return is_link_event(event_) && reaction_ == host::Reaction::hold; }

  CuttableLine& line_;
  Event event_;
  host::Reaction reaction_;
  bool watching_ = false, unsafe_again_ = false;
  States since_ = 0;
  std::optional<States> safe_at_;
  ServoState held_;
  std::uint32_t enabled_;
  int jump_ = 0, creep_ = 0;  // 100 urad
};

class Campaign {
 public:
  explicit Campaign(const Options& options) : options_(options) {}

  Result<Report> run() {
    for (int round = 0; round < options_.rounds; ++round) {
      if (round % kRoundsAWorld == 0) {
        KAZ_TRY(new_world(round));
      }
      KAZ_TRY(one(round));
      if (options_.progress) options_.progress(round + 1, options_.rounds);
    }
    return std::move(report_);
  }

 private:
  Result<void> new_world(int round) {
    sim::SimulationOptions options;
    options.mcu = sim::McuKind::h8;
    options.image_path = options_.image_path;
    options.world_path = options_.world_path;
    options.robot_path = options_.robot_path;
    options.camera_path = options_.camera_path;
    options.seed = mix64(options_.seed) + static_cast<std::uint64_t>(round);
    robot_.reset();
    line_.reset();
    auto simulation = KAZ_TRY(sim::Simulation::create(options));
    simulation_ = std::move(simulation);
    line_.emplace(*simulation_);
    return line_->sleep_until(milliseconds(200));  // the board starts
  }

  Result<void> one(int round) {
    Random random(mix64(options_.seed ^ mix64(static_cast<std::uint64_t>(round))));
    const auto event = static_cast<Event>(random.below(6));
    const auto reaction = random.chance(0.5) ? host::Reaction::limp : host::Reaction::hold;
    const Time before = milliseconds(60 + random.below(200)),
               // A board that was reset comes back by itself.
        outage = milliseconds(event == Event::reset ? 10 : 130 + random.below(900));
    const std::string name = std::string(kEventNames[static_cast<int>(event)]) +
                             (!is_link_event(event)              ? ""
                              : reaction == host::Reaction::limp ? ", limp"
                                                                 : ", hold");
    const auto wrong = [&](const std::string& what) {
      report_.failures.push_back("round " + std::to_string(round) + " (" + name + "): " + what);
    };

    Judge judge(*line_, event, reaction);
    line_->mcu().on_tick([&judge](const sim::TickRecord&) { judge.tick(); });
    if (auto connected = connect(reaction); !connected) {
      wrong("no start: " + connected.error().message);
      return new_world(round);
    }
    const Time start = line_->now(), at = start + before, end = at + outage;
    bool out = false, back = false;
    line_->each_ms = [&] {
      if (!out && line_->now() >= at) {
        out = true;
        begin(event);
        judge.lost(is_link_event(event) ? line_->last_arrival() : line_->simulation().now());
      }
      judge.check();
      if (out && !back && line_->now() >= end) {
        back = true;
        judge.over();
        finish(event);
      }
    };

    auto moved = move_until(at, random);
    if (moved && event == Event::host_killed) {
      robot_.reset();
      moved = line_->sleep_until(end);
      if (moved) moved = connect(reaction);
    }
    // The client searches for the board during the outage, inside one of these calls.
    if (moved) moved = move_until(end + milliseconds(1), random);
    const Time resumed = line_->now();
    if (moved) moved = move_until(resumed + milliseconds(60), random);
    line_->each_ms = nullptr;
    line_->mcu().on_tick(nullptr);

    Tally& tally = report_.tallies[name];
    ++tally.rounds;
    const auto reaction_ms = judge.reaction_ms();
    const double due = is_link_event(event) ? kReactionDue_ms : kSwitchOffDue_ms;
    if (!reaction_ms) {
      wrong("the motors never became safe");
    } else {
      tally.max_reaction_ms = std::max(tally.max_reaction_ms, *reaction_ms);
      if (*reaction_ms > due)
        wrong("motors safe only after " + std::to_string(*reaction_ms) + " ms");
    }
    if (judge.unsafe_again()) wrong("motors on again before the host was back");
    tally.max_jump_mrad = std::max(tally.max_jump_mrad, judge.jump_mrad());
    if (judge.jump_mrad() > 0) wrong("a joint was switched on with its target elsewhere");
    tally.max_creep_mrad = std::max(tally.max_creep_mrad, judge.creep_mrad());
    if (judge.creep_mrad() > 0) wrong("a held joint's command went on");
    if (!moved) {
      wrong("the client did not come back: " + moved.error().message);
      return new_world(round);
    }
    const double resume_ms = seconds(resumed - end) * 1e3;
    tally.max_resume_ms = std::max(tally.max_resume_ms, resume_ms);
    if (resume_ms > kResumeDue_ms)
      wrong("the client came back only after " + std::to_string(resume_ms) + " ms");
    if (servo_state(line_->mcu()).enabled != host::kAllJoints) wrong("not all motors are on again");
    return {};
  }

  Result<void> connect(host::Reaction reaction) {
    host::ConnectOptions options;
    options.reaction = reaction;
    auto robot = KAZ_TRY(host::Robot::connect(*line_, *line_, options));
    robot_.emplace(std::move(robot));
    return robot_->enable(host::kAllJoints);
  }

  // Oscillates all joints around the middle of their ranges, with a target every 10 ms.
  Result<void> move_until(Time end, Random& random) {
    const double phase = 6.28 * random.uniform();
    while (line_->now() < end) {
      const Time next_cycle = line_->now() + kCycle;
      std::array<host::JointTarget, KZ_JOINTS> targets;
      for (int j = 0; j < KZ_JOINTS; ++j) {
        const kz_board_joint& joint = kz_board_joints[j];
        const double middle = (joint.lower + joint.upper) * 0.5 / KZ_ANGLE_PER_RAD;
        const double range = (joint.upper - joint.lower) * 1.0 / KZ_ANGLE_PER_RAD;
        targets[static_cast<std::size_t>(j)] = {
            j, middle + 0.3 * range * std::sin(4.0 * seconds(line_->now()) + phase + j)};
      }
      const auto posture = robot_->exchange(targets, kRamp);
      if (!posture) return tl::unexpected(posture.error());
      if (auto slept = line_->sleep_until(next_cycle); !slept) return slept;
    }
    return {};
  }

  void begin(Event event) {
    switch (event) {
      case Event::cable:
        return line_->set(Line::cut);
      case Event::port:
        return line_->set(Line::gone);
      case Event::garbage:
        return line_->set(Line::garbled);
      case Event::host_killed:
        return;
      case Event::reset:
        return simulation_->board().reset();
      case Event::power:
        return simulation_->board().set_power(false);
    }
  }

  void finish(Event event) {
    line_->set(Line::whole);
    if (event == Event::power) simulation_->board().set_power(true);
  }

  const Options& options_;
  std::unique_ptr<sim::Simulation> simulation_;
  std::optional<CuttableLine> line_;
  std::optional<host::Robot> robot_;
  Report report_;
};

}  // namespace

std::string Report::table() const {
  using studies::text;
  studies::MarkdownTable table({"event", "rounds", "max reaction, ms", "max resume, ms",
                                "max jump, mrad", "max creep, mrad"});
  for (const auto& [name, t] : tallies) {
    table.add({name, std::to_string(t.rounds), text("%.2f", t.max_reaction_ms),
               text("%.1f", t.max_resume_ms), text("%.2f", t.max_jump_mrad),
               text("%.2f", t.max_creep_mrad)});
  }
  return table.text();
}

std::string Report::text() const {
  std::string text = table();
  for (const std::string& failure : failures) text += failure + "\n";
  return text;
}

Result<Report> run_campaign(const Options& options) {
  return Campaign(options).run();
}

}  // namespace kaz::campaign
