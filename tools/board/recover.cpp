// `kaz recover`: brings a board back, whatever address an interrupted run has left it at.
// SPDX-License-Identifier: Apache-2.0
#include "tools/board/recover.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "host/link/port_address.h"
#include "host/link/port_link.h"
#include "host/link/requester.h"
#include "host/link/wall_clock.h"
#include "host/robot/connect.h"
#include "host/robot/find_boards.h"
#include "host/robot/robot.h"
#include "shared/protocol/message_info.h"
#include "tools/base/arguments.h"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/base/provenance.h"
#include "tools/kept/kept_run.h"

namespace kaz::tools {
namespace {

Result<std::vector<std::uint8_t>> search(host::Link& link, host::Clock& clock, Time patience) {
  const Time until = clock.now() + patience;
  while (true) {
    auto found = KAZ_TRY(host::find_boards(link, clock));
    if (!found.empty() || clock.now() >= until) return found;
    KAZ_TRY(clock.sleep_until(clock.now() + std::chrono::milliseconds(100)));
  }
}

// Which of them: `others` are those of the notes.
Result<std::uint8_t> choose(std::vector<std::uint8_t> found, const std::string& port,
                            const RecoverOptions& options,
                            const std::vector<std::uint8_t>& others) {
  if (found.empty())
    return fail(Fault::environment,
                "no board answers at any of the 14 addresses on " + port +
                    ": check that the board is powered, the cable is plugged in, and no other "
                    "program has the port open; after an interrupted update, the board may wait in "
                    "its loader (check with `kaz flash info " +
                    host::robot_option(port) +
                    "`) or in boot mode (give `kaz flash write` with --reset)");
  if (options.found_at) {
    if (std::ranges::find(found, *options.found_at) != found.end()) return *options.found_at;
    return fail(Fault::usage,
                "no board answers at address " + std::to_string(*options.found_at) + " on " + port +
                    "; boards answer at these addresses, so give one of them with --found-at: " +
                    host::addresses_text(found));
  }
  if (found.size() > 1)
    std::erase_if(found,
                  [&](std::uint8_t a) { return std::ranges::find(others, a) != others.end(); });
  if (found.size() == 1) return found.front();
  return fail(Fault::usage, "boards answer at " + host::addresses_text(found) + " on " + port +
                                ": choose one with --found-at");
}

std::string motors(std::uint16_t status) {
  if (status & KZ_STATUS_HOLDING) return "held";
  return (status & (KZ_STATUS_ENABLED | KZ_STATUS_RAW_DRIVE)) != 0 ? "on" : "off";
}

std::string shutdown(std::uint16_t status) {
  const auto reason = static_cast<std::uint8_t>(status >> 8);
  return reason == KZ_SHUTDOWN_NONE ? "" : kz_shutdown_text(reason);
}

void print(const Recovered& result, const std::string& port) {
  std::printf("found at address %d on %s, motors %s%s%s\n", result.found_at, port.c_str(),
              motors(result.status_before).c_str(),
              shutdown(result.status_before).empty() ? "" : ", shut down: ",
              shutdown(result.status_before).c_str());
  for (const std::string& one : result.done) std::printf("restored: %s\n", one.c_str());
  for (const std::string& one : result.notes) std::printf("note: %s\n", one.c_str());
  for (const std::string& one : result.left) std::printf("not restored: %s\n", one.c_str());
  if (result.left.empty())
    std::printf(
        "reset; now at address %d, motors off%s%s\n", result.address,
        shutdown(result.status).empty() ? ", no shutdown is latched" : ", still shut down: ",
        shutdown(result.status).c_str());
  if (result.left.empty() && result.shared_line)
    std::printf(
        "the board refuses telemetry, because it is set to share its line with other boards; if it "
        "is the only board on the line, give --shared-line off\n");
}

nlohmann::ordered_json as_json(const Recovered& result, const std::string& port, bool ok) {
  return {{"ok", ok},
          {"port", port},
          {"found_at", result.found_at},
          {"motors_before", motors(result.status_before)},
          {"shutdown_before", shutdown(result.status_before)},
          {"address", result.address},
          {"shared_line", result.shared_line},
          {"shutdown", shutdown(result.status)},
          {"put_back", result.done},
          {"not_put_back", result.left},
          {"notes", result.notes}};
}

// Notes say nothing of which board they are of but its port.
Result<std::optional<KeptFile>> read_notes(const RecoverOptions& options, const std::string& port) {
  if (options.from.empty()) return std::nullopt;
  KeptFile kept = KAZ_TRY(read_kept(options.from));
  if (notes_in_use(kept))
    return fail(Fault::usage, options.from + ": " + kept.verb + " on " + kept.port +
                                  " is still running and will restore its board at the end: end "
                                  "that program, or leave --from out");
  if (!same_port(kept, port) && !options.port_changed)
    return fail(
        Fault::usage,
        options.from + ": these are notes of the board on " + kept.port + ", not on " + port +
            ": another board would get this address and calibration; if the same board is on " +
            port + " now, add --port-changed");
  return kept;
}

// They have served. Others than those of this program's folder are the user's.
void remove_notes(const std::string& path) {
  std::error_code error;
  if (path.empty() || kept_folder().empty() ||
      !std::filesystem::equivalent(std::filesystem::absolute(path).parent_path(), kept_folder(),
                                   error))
    return;
  if (!std::filesystem::remove(path, error) && error)
    std::fprintf(stderr,
                 "kaz recover: cannot delete the recovery notes, which are no longer needed (%s): "
                 "delete %s yourself\n",
                 error.message().c_str(), path.c_str());
}

}  // namespace

Result<Recovered> recover_board(host::Link& link, host::Clock& clock, const RecoverOptions& options,
                                const std::optional<KeptFile>& kept, Time patience) {
  auto found = KAZ_TRY(search(link, clock, patience));
  const auto at = KAZ_TRY(
      choose(found, link.name(), options, kept ? kept->others : std::vector<std::uint8_t>()));
  std::erase(found, at);

  host::Requester requester(link, clock, {.address = at});
  const auto identity = KAZ_TRY(host::identify_board(requester));
  host::BoardState target;
  target.shared_line = (identity.capabilities & KZ_CAPABILITY_TELEMETRY) == 0;
  if (kept) target = kept->board;
  if (options.address) target.address = *options.address;
  if (options.shared_line) target.shared_line = *options.shared_line;
  if (std::ranges::find(found, target.address) != found.end())
    return fail(Fault::usage, "another board is at address " + std::to_string(target.address) +
                                  " on " + link.name() + ": give another --address");
  const auto back = host::put_back(link, clock, target,
                                   {.flash = true, .settings = kept.has_value(), .others = found});
  Recovered result{at,          target.address, target.shared_line, identity.status,
                   back.status, back.done,      back.left,          back.notes};
  return result;
}

Result<bool> recover(const RecoverOptions& options) {
  const auto port = KAZ_TRY(parse_port(options.port));
  const auto kept = KAZ_TRY(read_notes(options, port.name()));
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  auto link = KAZ_TRY(host::open_port(port, &interrupt));
  host::WallClock clock(&interrupt);
  const auto recovered = recover_board(*link, clock, options, kept);
  // Also a failure because of the signal.
  if (!recovered && interrupt.requested() && recovered.error().fault != Fault::usage)
    return fail(Fault::interrupted, "interrupted while searching for the board on " + port.name() +
                                        "; nothing was changed: give the same command again");
  const auto result = KAZ_TRY(recovered);
  const bool ok = result.left.empty() && shutdown(result.status).empty();
  const bool cut_short = interrupt.requested() && !result.left.empty();
  if (options.json) {
    auto json = as_json(result, port.name(), ok);
    if (cut_short) mark_interrupted(json);
    json["provenance"] = provenance_json();
    print_json(json);
  } else if (!cut_short) {
    print(result, port.name());
  }
  if (cut_short) {
    std::string done;
    for (const std::string& one : result.done) done += (done.empty() ? "" : ", ") + one;
    return fail(Fault::interrupted,
                "interrupted before the board on " + port.name() + " was recovered; restored: " +
                    (done.empty() ? "nothing" : done) + "; give the same command again");
  }
  if (result.left.empty()) remove_notes(options.from);
  for (const std::string& sentence : earlier_notes(port.name()))
    std::fprintf(stderr, "kaz recover: %s\n", sentence.c_str());
  return ok;
}

}  // namespace kaz::tools
