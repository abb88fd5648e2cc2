// `kaz status`: reads the state of a board; moves and changes nothing.
// SPDX-License-Identifier: Apache-2.0
#include "tools/board/board_status.h"

#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "host/flash/diagnostic.h"
#include "host/link/port_link.h"
#include "host/link/wall_clock.h"
#include "host/robot/connect.h"
#include "host/robot/robot.h"
#include "shared/servo/tick.h"
#include "tools/base/arguments.h"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/base/provenance.h"
#include "tools/kept/kept_run.h"

namespace kaz::tools {
namespace {

using Json = nlohmann::ordered_json;

const char* cause_of_reset(std::uint8_t cause) {
  switch (cause) {
    case KZ_RESET_POWER:
      return "power";
    case KZ_RESET_WATCHDOG:
      return "watchdog";
    default:
      return "command";
  }
}

const char* motors(std::uint16_t status) {
  if (status & KZ_STATUS_HOLDING) return "held";
  return (status & (KZ_STATUS_ENABLED | KZ_STATUS_RAW_DRIVE)) ? "on" : "off";
}

// The board's whole numbers of 0.1 or 0.001 as they print: 249 of 0.1 are 24.9, not 24.900000000000002.
double whole(double value, int per_unit) {
  return std::round(value * per_unit) / per_unit;
}

Json as_json(const kz_identify_reply& board, const host::Health& health, const host::SelfTest& test,
             const kz_statistics_reply& counts) {
  Json json{
      {"protocol", board.protocol_version},
      {"joints", board.joints},
      {"firmware", host::firmware_version_text(board.firmware_version)},
      {"build", host::build_text(board.build_id)},
      {"since_reset_s", health.tick / 1e3},
      {"last_reset", cause_of_reset(board.reset_cause)},
      {"motors", motors(health.status)},
      {"calibrated", (health.status & KZ_STATUS_UNCALIBRATED) == 0},
      {"supply_v", whole(health.supply_volts, 1000)},
      {"supply_lowest_v", whole(health.supply_lowest_volts, 1000)},
      {"drivers_celsius", whole(health.temperature_c, 10)},
      {"watchdog_ms", board.watchdog_10ms * 10},
      {"reaction", board.reaction == KZ_REACTION_HOLD ? "hold" : "limp"},
      {"missed_ticks", counts.missed_ticks},
      {"frames", counts.frames},
      {"refusals", counts.refusals},
      {"damaged_frames", counts.bad_check + counts.bad_stuffing + counts.too_short +
                             counts.too_long + counts.line_errors + counts.overruns + counts.idle}};
  // What is not there is absent; the native engine has no image.
  if (board.image_crc != 0) json["crc"] = host::hex_word(board.image_crc);
  if (const auto fault = host::firmware_fault(board); !fault.empty())
    json["firmware_fault"] = fault;
  if (!test.failed_names.empty()) json["self_test_failed"] = test.failed_names;
  if (!health.shutdown.empty()) {
    json["shutdown"] = health.shutdown;
    json["shutdown_at_s"] = health.shutdown_tick / 1e3;
  }
  if (health.joint)
    json["joint"] = host::joint_table()[static_cast<std::size_t>(*health.joint)].name;
  return json;
}

void print(const Json& now, const std::string& fault) {
  std::printf("motors %s", now["motors"].get<std::string>().c_str());
  if (!fault.empty()) {
    std::printf("; shutdown %.1f s after the last reset, which was %.1f s ago: %s\n",
                now["shutdown_at_s"].get<double>(), now["since_reset_s"].get<double>(),
                fault.c_str());
  } else {
    std::printf(", no shutdown is latched; last reset %.1f s ago, by %s\n",
                now["since_reset_s"].get<double>(), now["last_reset"].get<std::string>().c_str());
  }
  std::printf("supply %.1f V, lowest %.1f V; motor drivers %.0f degrees Celsius\n",
              now["supply_v"].get<double>(), now["supply_lowest_v"].get<double>(),
              now["drivers_celsius"].get<double>());
  if (const auto wrong = now.value("firmware_fault", std::string()); !wrong.empty())
    print_lines("the board: %s\n", wrong.c_str());
  const auto failed = now.value("self_test_failed", std::string());
  print_lines("self-test: %s; calibration: %s\n", failed.empty() ? "passed" : failed.c_str(),
              now["calibrated"].get<bool>()
                  ? "from flash"
                  : "not stored; the board uses nominal values, or values that a host has set");
  print_lines(
      "link: %d frames received, %d requests refused, %d frames damaged; watchdog reaction after "
      "%d "
      "ms without a request: %s\n",
      now["frames"].get<int>(), now["refusals"].get<int>(), now["damaged_frames"].get<int>(),
      now["watchdog_ms"].get<int>(), now["reaction"].get<std::string>().c_str());
  std::printf("ticks missed: %d\n", now["missed_ticks"].get<int>());
}

Result<bool> read_status(const StatusOptions& arguments) {
  const auto port = KAZ_TRY(parse_port(arguments.port));
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  auto link = KAZ_TRY(host::open_port(port, &interrupt));
  host::WallClock clock(&interrupt);
  // The link watchdog stays as it is, with its reaction.
  auto robot = host::Robot::connect(
      *link, clock,
      {.address = arguments.address, .watchdog = Time::zero(), .reconnect = Time::zero()});
  if (!robot) return tl::unexpected(with_earlier_notes(robot.error(), port.name()));
  const auto health = KAZ_TRY(robot->health());
  const auto test = KAZ_TRY(robot->self_test());
  const auto counts = KAZ_TRY(robot->board_statistics());
  Json now = as_json(robot->identity(), health, test, counts);
  if (arguments.json) {
    now["provenance"] = provenance_json();
    print_json(now);
  } else {
    print_lines("%s\n", host::board_text(robot->identity()).c_str());
    print(now, health.shutdown.empty() ? "" : robot->describe_fault(health.status));
  }
  for (const std::string& sentence : earlier_notes(port.name()))
    std::fprintf(stderr, "kaz status: %s\n", sentence.c_str());
  return health.shutdown.empty();
}

}  // namespace

Result<bool> print_status(const StatusOptions& arguments) {
  return read_status(arguments);
}

}  // namespace kaz::tools
