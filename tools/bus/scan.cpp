// Opens the port at each rate, and prints who answers.
// SPDX-License-Identifier: Apache-2.0
#include "tools/bus/scan.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "host/bus/bus_scan.h"
#include "host/link/port_link.h"
#include "host/link/wall_clock.h"
#include "tools/base/arguments.h"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/base/provenance.h"
#include "tools/base/time_lost.h"

namespace kaz::tools {
namespace {

using host::ScannedServo;
using servo_bus::Protocol;
using Json = nlohmann::ordered_json;

struct Found {
  Protocol protocol;
  long baud;
  ScannedServo servo;
  std::vector<host::ScanRemark> remarks;
};

double median_ms(std::vector<double> values) {
  if (values.empty()) return NAN;
  std::ranges::sort(values);
  return 1e3 * values[values.size() / 2];
}

std::string model_of(const ScannedServo& servo) {
  if (servo.model != nullptr) return std::string(servo.model->name);
  return servo.number < 0 ? "?" : "model " + std::to_string(servo.number);
}

Json as_json(const Found& found) {
  const ScannedServo& servo = found.servo;
  Json json{{"protocol", servo_bus::name_of(found.protocol)},
            {"baud", found.baud},
            {"id", servo.id},
            {"model", model_of(servo)},
            {"requests", servo.requests},
            {"lost", servo.lost},
            {"damaged", servo.damaged}};
  const auto add = [&json](const char* name, double value, double unit) {
    if (std::isfinite(value)) json[name] = std::round(value / unit) * unit;
  };
  if (servo.number >= 0) json["model_number"] = servo.number;
  add("volts", servo.volts, 0.1);
  add("lowest_volts", servo.lowest_volts, 0.1);
  add("celsius", servo.celsius, 1);
  if (std::isfinite(servo.return_delay_s)) json["return_delay_s"] = servo.return_delay_s;
  if (servo.torque >= 0) json["torque"] = servo.torque != 0;
  add("round_trip_median_ms", median_ms(servo.round_trips_s), 1e-3);
  json["errors"] = servo.errors;
  json["remarks"] = Json::array();
  for (const host::ScanRemark& one : found.remarks)
    json["remarks"].push_back({{"wrong", one.wrong}, {"text", one.text}});
  return json;
}

std::string number(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  char text[40];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

void print(const std::vector<Found>& all) {
  std::printf("%3s  %-12s %-9s %8s %6s %4s %-6s %9s %5s\n", "id", "model", "protocol", "baud", "V",
              "degC", "torque", "answer ms", "bad");
  for (const Found& one : all) {
    const ScannedServo& servo = one.servo;
    std::printf("%3d  %-12s %-9s %8ld %6s %4s %-6s %9s %5d\n", servo.id, model_of(servo).c_str(),
                std::string(servo_bus::name_of(one.protocol)).c_str(), one.baud,
                number(servo.volts, 1).c_str(), number(servo.celsius, 0).c_str(),
                servo.torque < 0 ? "-" : (servo.torque != 0 ? "on" : "off"),
                number(median_ms(servo.round_trips_s), 2).c_str(), servo.lost + servo.damaged);
    for (const host::ScanRemark& remark : one.remarks)
      std::printf("     %s: %s\n", remark.wrong ? "wrong" : "note", remark.text.c_str());
  }
}

// Of the whole bus: what an adapter or the supply does to all of them.
std::vector<host::ScanRemark> of_bus(const std::vector<Found>& all) {
  std::vector<host::ScanRemark> remarks;
  char text[200];
  std::vector<double> trips;
  double lowest = INFINITY, highest = -INFINITY;
  for (const Found& one : all) {
    trips.insert(trips.end(), one.servo.round_trips_s.begin(), one.servo.round_trips_s.end());
    if (std::isfinite(one.servo.volts)) {
      lowest = std::min(lowest, one.servo.lowest_volts);
      highest = std::max(highest, one.servo.volts);
    }
  }
  if (const double median = median_ms(trips); median > 5) {
    std::snprintf(text, sizeof text,
                  "answers take %.1f ms: the adapter delays the answers; `kaz doctor` prints the "
                  "command that sets the adapter's latency to 1 ms",
                  median);
    remarks.push_back({false, text});
  }
  if (highest - lowest >= 0.5) {
    std::snprintf(text, sizeof text,
                  "voltages from %.1f to %.1f V: the voltage drops along the chain; use thicker "
                  "wires, or feed the chain from both ends",
                  lowest, highest);
    remarks.push_back({false, text});
  }
  if (std::ranges::any_of(all, [&all](const Found& one) { return one.baud != all[0].baud; }))
    remarks.push_back({true,
                       "the servos use different rates, but a program uses only one rate: set all "
                       "servos to the same rate"});
  return remarks;
}

constexpr const char* kScanAgain = "end other programs and scan again";

// "3, 5-7"
std::string ids_text(const std::set<int>& ids) {
  std::string text;
  for (auto first = ids.begin(); first != ids.end();) {
    int last = *first;
    auto next = std::next(first);
    for (; next != ids.end() && *next == last + 1; ++next) last = *next;
    text += (text.empty() ? "" : ", ") + std::to_string(*first);
    if (last != *first) text += "-" + std::to_string(last);
    first = next;
  }
  return text;
}

// Protocols and rates to try, in this order.
std::vector<std::pair<Protocol, long>> places_of(const BusScanOptions& options,
                                                 const std::optional<Protocol>& given,
                                                 const std::vector<long>& bauds) {
  std::vector<std::pair<Protocol, long>> places;
  for (const Protocol protocol : {Protocol::feetech, Protocol::dynamixel}) {
    if (given && given != protocol) continue;
    if (!options.protocol.empty() && options.protocol != servo_bus::name_of(protocol)) continue;
    for (const long baud : bauds.empty() ? host::bus_rates(protocol) : bauds)
      places.emplace_back(protocol, baud);
  }
  return places;
}

struct BusFindings {
  std::vector<Found> servos;
  std::set<int> undecided;  // ids that may have a servo
  std::string excuse;       // why the last of these ids is undecided
};

// Prints the findings on the bus at `port`, as JSON or as a table.
Result<ExitStatus> report(BusFindings findings, const std::string& port, bool json_output) {
  auto& [all, undecided, excuse] = findings;
  auto remarks = of_bus(all);
  for (const Found& one : all) undecided.erase(one.servo.id);
  if (!undecided.empty())
    remarks.push_back({false, "it is undecided whether a servo has id " + ids_text(undecided) +
                                  ": " + excuse + "; " + kScanAgain});
  const bool late = !undecided.empty() ||
                    std::ranges::any_of(all, [](const Found& one) { return one.servo.late > 0; });
  bool good = !all.empty();
  for (const Found& one : all)
    for (const host::ScanRemark& remark : one.remarks) good = good && !remark.wrong;
  for (const host::ScanRemark& remark : remarks) good = good && !remark.wrong;
  // No fault was found, but some requests are undecided.
  const auto outcome =
      good && late ? ExitStatus::with_status(static_cast<int>(Fault::environment)) : ExitStatus(good);
  if (json_output) {
    Json json{{"port", port}, {"ok", good}, {"servos", Json::array()}};
    for (const Found& one : all) json["servos"].push_back(as_json(one));
    json["remarks"] = Json::array();
    for (const host::ScanRemark& one : remarks)
      json["remarks"].push_back({{"wrong", one.wrong}, {"text", one.text}});
    json["provenance"] = provenance_json();
    print_json(json);
    return outcome;
  }
  if (all.empty() && late)
    return fail(Fault::environment, "no servo answers on " + port +
                                        ", but it is undecided whether a servo is there, because " +
                                        excuse + "; " + kScanAgain);
  if (all.empty()) {
    std::printf(
        "no servo answers on %s: check its supply and the plug next to the adapter, and end other "
        "programs that use the port\n",
        port.c_str());
    return false;
  }
  print(all);
  for (const host::ScanRemark& remark : remarks)
    print_lines("%s: %s\n", remark.wrong ? "wrong" : "note", remark.text.c_str());
  return outcome;
}

}  // namespace

Result<ExitStatus> run_bus_scan(const BusScanOptions& options) {
  const auto bus = KAZ_TRY(parse_bus(options.robot));
  auto address = bus.port;
  if (bus.protocol && !options.protocol.empty())
    return fail(Fault::usage, "--protocol " + options.protocol + ": --robot " + options.robot +
                                  " already gives a protocol; leave out --protocol");
  if (address.baud != 0 && !options.bauds.empty())
    return fail(Fault::usage,
                "--baud: --robot " + options.robot + " already gives a rate; leave out --baud");
  const std::vector<long> bauds =
      address.baud != 0 ? std::vector<long>{address.baud} : options.bauds;
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  host::WallClock clock(&interrupt);
  const auto places = places_of(options, bus.protocol, bauds);
  BusFindings findings;
  auto& all = findings.servos;
  Progress progress("kaz bus scan", options.json);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto& [protocol, baud] = places[i];
    address.baud = static_cast<int>(baud);
    auto link = host::open_port(address, &interrupt);
    // Not all adapters have all rates.
    if (!link && link.error().fault == Fault::usage && bauds.empty()) continue;
    if (!link) return tl::unexpected(link.error());
    host::ScanOptions scan;
    scan.first_id = options.first_id;
    scan.last_id = options.last_id;
    scan.readings = options.readings;
    // An adapter without low latency keeps answers for 16 ms.
    const auto latency = (*link)->low_latency();
    if (latency == host::LowLatency::refused || latency == host::LowLatency::network)
      scan.within = std::chrono::milliseconds(25);
    scan.progress = [&](int id) {
      const double share = static_cast<double>(id - scan.first_id) /
                           static_cast<double>(scan.last_id - scan.first_id + 1);
      progress.update((static_cast<double>(i) + share) / static_cast<double>(places.size()),
                      std::string(servo_bus::name_of(protocol)) + ", " + std::to_string(baud) +
                          " baud, " + std::to_string(all.size()) + " found");
    };
    host::LatenessMeter meter(**link, clock, time_lost_behind((*link)->name(), interrupt));
    scan.lateness = &meter;
    scan.undecided = [&](int id, const std::string& why) {
      findings.undecided.insert(id);
      findings.excuse = why;
    };
    const auto found = host::scan_bus(meter, meter, protocol, baud, scan);
    if (!found && interrupt.requested()) {
      progress.done();
      if (!options.json) print(all);
      return fail(Fault::interrupted, "interrupted; the remaining ids and rates were not tried");
    }
    for (const ScannedServo& servo : KAZ_TRY(found))
      all.push_back({protocol, baud, servo, host::remarks_on(servo, protocol)});
  }
  progress.done();
  return report(std::move(findings), address.name(), options.json);
}

}  // namespace kaz::tools
