// Records a pendulum on a bus servo, and writes the logs.
// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/pendulum_run.h"

#include <cstdio>
#include <numbers>

#include <nlohmann/json.hpp>

#include "host/link/port_link.h"
#include "host/link/wall_clock.h"
#include "tools/base/arguments.h"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/base/output_file.h"
#include "tools/base/prompt.h"
#include "tools/base/provenance.h"

namespace kaz::tools {
namespace {

const OutputKind& pendulum_output() {
  static const OutputKind kind{"bench pendulum", {"record.json", "fit-p*.csv", "held-p*.csv"}};
  return kind;
}

nlohmann::ordered_json json_of(const hil::PendulumRecord& record, const std::string& port) {
  nlohmann::ordered_json all{{"port", port},
                             {"servo", record.servo},
                             {"celsius", record.celsius},
                             {"lowest_volts", record.volts},
                             {"largest_amps", record.largest_amps},
                             {"logs", nlohmann::ordered_json::array()}};
  for (const hil::PendulumLog& one : record.logs)
    all["logs"].push_back({{"file", one.name + ".csv"},
                           {"goals", one.follows_profile ? "profile" : "sent"},
                           {"held_out", one.held_out},
                           {"gain_per_rad", one.log.gain_per_rad},
                           {"samples", one.log.samples.size()},
                           {"missing", one.missing}});
  all["provenance"] = provenance_json();
  return all;
}

}  // namespace

Result<bool> record_pendulum_logs(PendulumArguments arguments) {
  hil::PendulumOptions& recorder = arguments.recorder;
  const auto bus = KAZ_TRY(parse_one_bus(arguments.robot, arguments.protocol, arguments.baud));
  recorder.protocol = *bus.protocol;
  const host::PortAddress& port = bus.port;
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  const auto folder = KAZ_TRY(OutputFolder::open(arguments.out, pendulum_output()));
  const auto link = KAZ_TRY(host::open_port(port, &interrupt));
  host::WallClock clock(&interrupt);
  if (!arguments.yes) {
    char text[200];
    std::snprintf(text, sizeof text,
                  "The weight swings %.0f degrees to either side for two minutes: keep clear of "
                  "it. Press Enter to continue, n to stop",
                  arguments.amplitude_deg);
    const auto reply = KAZ_TRY(prompt_user(
        text, interrupt,
        "a swinging weight needs somebody at the keyboard, or --yes for a script; nothing was "
        "moved"));
    if (!reply.empty() && reply != "y" && reply != "yes")
      return fail(Fault::failed, "stopped; nothing was moved");
  }
  Progress progress("kaz bench pendulum", arguments.json);
  recorder.amplitude_rad = arguments.amplitude_deg * std::numbers::pi / 180;
  recorder.interrupt = &interrupt;
  recorder.progress = [&](double share, const std::string& what) { progress.update(share, what); };
  leaves_behind("the servo on " + port.name() +
                " may still hold the weight: switch off the servo's supply");
  const auto recorded = hil::record_pendulum(*link, clock, recorder);
  leaves_behind("");
  progress.done();
  const auto record = KAZ_TRY(recorded);
  const auto json = json_of(record, port.name());
  KAZ_TRY(folder.clear());
  for (const hil::PendulumLog& one : record.logs)
    KAZ_TRY(folder.write(one.name + ".csv", hil::servo_log_text(one.log)));
  KAZ_TRY(folder.write_json("record.json", json));
  if (arguments.json) {
    print_json(json);
    return true;
  }
  std::printf("%-24s %8s %8s %8s\n", "log", "gain", "samples", "missing");
  for (const hil::PendulumLog& one : record.logs)
    std::printf("%-24s %8.2f %8zu %8d\n", one.name.c_str(), one.log.gain_per_rad,
                one.log.samples.size(), one.missing);
  std::printf(
      "%s: highest temperature %.0f degC, largest current %.2f A, lowest voltage %.1f V; the logs "
      "are in %s\n",
      record.servo.c_str(), record.celsius, record.largest_amps, record.volts,
      folder.folder().c_str());
  return true;
}

}  // namespace kaz::tools
