// `kaz replay LOG.log`: requests from a CAN log, sent to a virtual or a real board.
// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/replay_can.h"

#include <cstdio>
#include <filesystem>
#include <set>

#include <nlohmann/json.hpp>

#include "host/link/can_link.h"
#include "host/link/requester.h"
#include "host/robot/typed_request.h"
#include "shared/base/counted.hpp"
#include "shared/base/files.hpp"
#include "shared/base/hex_text.hpp"
#include "tools/base/arguments.h"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/base/provenance.h"
#include "tools/replay/can_answers.h"
#include "tools/run/backend.h"

namespace kaz::tools {
namespace {

constexpr std::size_t kLargestLog = std::size_t{256} << 20;  // bytes: several hours of a busy bus
// A board that starts with the simulation answers after 200 ms (clause TIME-4 of the protocol).
constexpr Time kLead = std::chrono::milliseconds(500);

std::string hex_of(const std::vector<std::uint8_t>& body) {
  return body.empty() ? "nothing" : hex_text(body, " ");
}

std::string identifier(std::uint32_t id) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%X", static_cast<unsigned>(id));
  return text;
}

struct CanReplay {
  std::string robot;  // name of the link
  std::size_t requests = 0, incomplete = 0;
  std::size_t damaged = 0;  // answers of the log with a wrong check
  CanComparison comparison;
  bool identical() const { return comparison.differences.empty(); }
};

void print_can_json(const ReplayCanOptions& options, const CanReplay& replay) {
  auto differences = nlohmann::ordered_json::array();
  for (const CanDifference& one : replay.comparison.differences)
    differences.push_back({{"line", one.line},
                           {"time_s", seconds(one.time)},
                           {"id", one.id},
                           {"what", one.what},
                           {"recorded", hex_of(one.recorded)},
                           {"now", hex_of(one.now)},
                           {"count", one.count}});
  nlohmann::ordered_json measured = nlohmann::ordered_json::object();
  for (const auto& [name, one] : replay.comparison.measured)
    measured[name] = {{"largest_difference", one.largest}, {"unit", one.unit}};
  print_json({{"log", options.file},
              {"robot", replay.robot},
              {"identical", replay.identical()},
              {"requests", replay.requests},
              {"answers", replay.comparison.answers},
              {"telemetry_frames", replay.comparison.telemetry},
              {"incomplete_messages", replay.incomplete},
              {"damaged_answers", replay.damaged},
              {"differences", differences},
              {"measured", measured},
              {"provenance", provenance_json()}});
}

void print_can_text(const ReplayCanOptions& options, const CanReplay& replay) {
  const CanComparison& result = replay.comparison;
  print_lines("sent %s of the log to %s, and compared %s\n",
              counted(replay.requests, "request").c_str(), replay.robot.c_str(),
              counted(result.answers, "answer").c_str());
  if (result.telemetry > 0)
    print_lines("not compared: %s\n", counted(result.telemetry, "telemetry frame").c_str());
  if (replay.incomplete > 0)
    print_lines("left out: %s of the log without all frames\n",
                counted(replay.incomplete, "message").c_str());
  if (replay.damaged > 0)
    print_lines("left out: %s of the log with a wrong check\n",
                counted(replay.damaged, "answer").c_str());
  for (const CanDifference& one : result.differences) {
    const std::string at =
        one.line > 0 ? options.file + ":" + std::to_string(one.line) : options.file;
    const std::string more =
        one.count > 1 ? " (also in " + counted(one.count - 1, "later answer") + ")" : "";
    print_lines("%s: %.6f s, %s, %s%s\n", at.c_str(), seconds(one.time), identifier(one.id).c_str(),
                one.what.c_str(), more.c_str());
    print_lines("  recorded: %s\n  now:      %s\n", hex_of(one.recorded).c_str(),
                hex_of(one.now).c_str());
  }
  if (replay.identical()) std::printf("identical, except for measured values\n");
  std::string measured;
  for (const auto& [name, one] : result.measured) {
    if (one.largest == 0) continue;
    measured += (measured.empty() ? "" : ", ") + name + " " + std::to_string(one.largest) +
                (one.unit.empty() ? "" : " * " + one.unit);
  }
  if (!measured.empty())
    print_lines("largest differences of measured values: %s\n", measured.c_str());
}

// Switches off the motors of the boards that the log names. Also tries the other boards if one fails.
Result<void> switch_boards_off(const CanMessages& log, host::Link& link, host::Clock& clock) {
  std::set<std::uint8_t> addresses;
  for (const CanMessage& message : log.messages) {
    const auto address = static_cast<std::uint8_t>(message.id & 15);
    if (address <= KZ_ADDRESS_LAST) addresses.insert(address);
  }
  Result<void> result;
  for (const std::uint8_t address : addresses) {
    host::RequesterOptions options;
    options.address = address;
    host::Requester requester(link, clock, options);
    const auto reply = requester.exchange_at_once(
        host::make_request(KZ_TYPE_enable, kz_enable{0}, kz_pack_enable));
    if (!reply && result)
      result = fail(reply.error().fault, "the motors of the board at address " +
                                             std::to_string(address) + " may be on (" +
                                             reply.error().message + "): cut their power");
  }
  return result;
}

Result<void> check_robot(const std::string& robot) {
  if (!names_servo_bus(robot) && !robot.starts_with("boards:")) return {};
  return fail(Fault::usage, "--robot " + robot +
                                " is not valid with a CAN log: give sim or the port of one line of "
                                "boards, such as can:can0");
}

}  // namespace

bool names_can_log(const std::string& path) {
  std::error_code error;
  return path.ends_with(".log") && !std::filesystem::is_directory(path, error);
}

Result<bool> replay_can(const ReplayCanOptions& options) {
  KAZ_TRY(check_robot(options.backend.robot));
  const std::string text =
      KAZ_TRY(read_whole_file(options.file, kLargestLog, "give a log of `candump -l`"));
  const auto frames = KAZ_TRY(parse_can_log(options.file, text));
  const CanMessages log = KAZ_TRY(can_messages(options.file, frames));
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  const auto backend = KAZ_TRY(SessionBackend::open(options.backend, interrupt));
  auto now = repeat_requests(log, backend->link(), backend->clock(), kLead);
  Result<void> off;
  if (options.backend.at_port()) {
    const host::CleanUp clean_up(interrupt);
    off = switch_boards_off(log, backend->link(), backend->clock());
  }
  if (!off) return tl::unexpected(off.error());
  if (!now) return tl::unexpected(now.error());
  const auto recorded = answers_in(log);
  CanReplay replay{backend->link().name(), 0, log.incomplete, 0, compare_answers(recorded, *now)};
  for (const CanMessage& message : log.messages) replay.requests += message.from_host ? 1 : 0;
  replay.damaged = log.messages.size() - replay.requests - recorded.size();
  if (options.json) {
    print_can_json(options, replay);
  } else {
    print_can_text(options, replay);
  }
  return replay.identical();
}

}  // namespace kaz::tools
