// Which measurements are made, in which order, and what becomes of the rest.
// SPDX-License-Identifier: Apache-2.0
#include "hil/bench/motor/motor_bench.h"

#include <algorithm>
#include <cmath>
#include <regex>
#include <vector>

#include "hil/bench/timed_part.h"

namespace kaz::hil {
namespace {

// Angles and torques are timed by the board: only a stop of this program or of a simulator counts.
constexpr Time kBorne = std::chrono::milliseconds(100);

struct Part {
  std::string what;
  std::vector<std::string> names;
  bool needs_stand;
  bool drives;  // switches the motor on
  std::function<void(MotorOnBench&, BenchJudge&)> run;
};

constexpr const char* kDirection = "direction";

// What one part finds out for others.
struct Found {
  std::optional<double> slope;  // Nm/V
  bool reversed = false;
  bool enter_direction = true;  // the filter takes it
};

// Torques want a cold motor, and heat takes minutes to go.
std::vector<Part> parts_of(double supply_volts, Found& found) {
  return {
      {"direction",
       {kDirection},
       false,
       true,
       [&found](MotorOnBench& motor, BenchJudge& judge) {
         found.reversed = !measure_direction(motor, judge, found.enter_direction);
       }},
      {"noise of the potentiometer", {"pot.noise"}, false, false, measure_potentiometer_noise},
      {"scale and linearity of the potentiometer",
       {"pot.linearity", "pot.scale", "pot.offset"},
       true,
       false,
       measure_potentiometer_line},
      {"backlash", {"backlash"}, true, false, measure_backlash},
      {"torque at standstill",
       {"stall.torque_4v8", "stall.torque_10v", "stall.slope", "stall.line_error",
        "stall.asymmetry", "friction.sliding"},
       true,
       true,
       [&found, supply_volts](MotorOnBench& motor, BenchJudge& judge) {
         found.slope = measure_stall(motor, judge, supply_volts);
       }},
      {"dead band",
       {"dead_band", "friction.breakaway"},
       false,
       true,
       [&found, supply_volts](MotorOnBench& motor, BenchJudge& judge) {
         measure_dead_band(motor, judge, supply_volts, found.slope);
       }},
      {"speed without load",
       {"no_load.speed", "no_load.slope", "start.time_constant", "friction.running"},
       false,
       true,
       [&found](MotorOnBench& motor, BenchJudge& judge) {
         measure_speed(motor, judge, found.slope);
       }},
      {"step",
       {"step.rise_time", "step.overshoot", "step.settling_time", "step.error", "step.hunting"},
       false,
       true,
       measure_step},
      {"frequency response",
       {"frequency.bandwidth", "frequency.phase_2hz"},
       false,
       true,
       measure_frequency},
      {"heat",
       {"thermal.torque_loss"},
       true,
       true,
       [supply_volts](MotorOnBench& motor, BenchJudge& judge) {
         measure_heat(motor, judge, supply_volts);
       }},
  };
}

// What a failed part has not entered yet has failed with it.
void fail_rest(const Part& part, const std::string& subject,
               const std::vector<std::string>& entered, const std::string& why, BenchJudge& judge) {
  for (const std::string& name : part.names) {
    if (std::ranges::find(entered, name) == entered.end())
      judge.enter(subject, name, std::nan(""), 0, why);
  }
}

// After a failure. What cannot be tidied fails the next one.
void tidy(MotorOnBench& motor, double supply_volts) {
  try {
    motor.come_to_rest();
  } catch (const Failed&) {
  }
  if (motor.has_stand()) {
    sure(motor.stand().press(motor.joint(), 0));
    sure(motor.stand().let_go(motor.joint()));
    sure(motor.stand().clamp(motor.joint(), false));
    sure(motor.stand().set_supply(supply_volts));
    motor.wait(0.1);
  }
}

Result<std::vector<Part>> chosen_parts(const std::vector<Part>& parts, const std::string& filter) {
  std::vector<Part> taken;
  try {
    const std::regex pattern(filter);
    for (const Part& part : parts) {
      if (std::ranges::any_of(part.names, [&](const std::string& name) {
            return std::regex_search(name, pattern);
          }))
        taken.push_back(part);
    }
  } catch (const std::regex_error& wrong) {
    return fail(Fault::usage,
                "--filter " + filter + " is not a regular expression: " + wrong.what());
  }
  if (taken.empty())
    return fail(Fault::usage,
                "--filter " + filter +
                    " matches no measurement of a motor; `kaz bench list` lists the measurements");
  return taken;
}

// Whatever is chosen, nothing drives the motor before it has been looked where it turns to.
void begin_with_direction(std::vector<Part>& chosen, const std::vector<Part>& all, bool has_stand,
                          Found& found) {
  if (chosen.front().names.front() == kDirection) return;
  if (std::ranges::none_of(chosen, [&](const Part& part) {
        return part.drives && (has_stand || !part.needs_stand);
      }))
    return;
  found.enter_direction = false;
  chosen.insert(chosen.begin(), all.front());
}

void leave_out(const Part& part, const std::string& subject, const std::string& why,
               BenchJudge& judge) {
  for (const std::string& name : part.names) judge.leave_out(subject, name, why);
}

void run_part(const Part& part, MotorOnBench& motor, BenchJudge& judge, double supply_volts,
              bool reversed) {
  if (reversed)
    return leave_out(part, motor.name(), "not run, because the measurement `direction` failed",
                     judge);
  if (part.needs_stand && !motor.has_stand())
    return leave_out(
        part, motor.name(),
        "this measurement needs a motor stand: give --stand ctl:PATH or --stand manual", judge);
  const std::size_t before = judge.report().measurements.size();
  try {
    motor.come_to_rest();
    part.run(motor, judge);
  } catch (const Failed& failed) {
    std::vector<std::string> entered;
    const auto& all = judge.report().measurements;
    for (std::size_t i = before; i < all.size(); ++i) entered.push_back(all[i].of->name);
    fail_rest(part, motor.name(), entered, failed.message, judge);
    tidy(motor, supply_volts);
  }
}

}  // namespace

host::ConnectOptions bench_connection() {
  host::ConnectOptions options;
  options.watchdog = std::chrono::milliseconds(500);
  options.reaction = host::Reaction::limp;
  return options;
}

Result<void> check_motor_filter(const std::string& filter) {
  Found none;
  const auto parts = chosen_parts(parts_of(0, none), filter);
  if (!parts) return tl::unexpected(parts.error());
  return {};
}

Result<void> bench_motor(host::Robot& robot, Stand* stand, const MotorBenchOptions& options,
                         BenchJudge& judge) {
  Found found;
  const std::vector<Part> all = parts_of(options.supply_volts, found);
  auto parts = KAZ_TRY(chosen_parts(all, options.filter));
  begin_with_direction(parts, all, stand != nullptr, found);
  if (options.joint < 0 || options.joint >= KZ_JOINTS)
    return fail(Fault::usage, "joint " + std::to_string(options.joint) + ": must be 0 to 17");
  try {
    MotorOnBench motor(robot, stand, options.joint, options.gains);
    motor.come_to_rest();
    if (stand) {
      sure(stand->put_back(options.supply_volts));
      judge.report().conditions = {{"disc_kgm2", sure(stand->disc_kgm2())},
                                   {"supply_volts", options.supply_volts},
                                   {"pressing_s", stand->pressing_s()}};
    }
    for (std::size_t i = 0; i < parts.size(); ++i) {
      KAZ_TRY(timed_part(
          judge,
          [&](int run) -> Result<void> {
            if (options.progress)
              options.progress(static_cast<double>(i) / static_cast<double>(parts.size()),
                               run_text(motor.name() + ": " + parts[i].what, run));
            try {
              // A repetition decides anew.
              if (parts[i].names.front() == kDirection) found.reversed = false;
              run_part(parts[i], motor, judge, options.supply_volts, found.reversed);
            } catch (const Lost& lost) {
              return tl::unexpected(lost.error);
            }
            return {};
          },
          kBorne, [&motor] { return motor.take_line_trouble(); }));
    }
  } catch (const Lost& lost) {
    return tl::unexpected(lost.error);
  } catch (const Failed& failed) {  // before the first part
    return fail(Fault::environment, "the motor cannot be measured: " + failed.message);
  }
  return {};
}

}  // namespace kaz::hil
