// `kaz mcu compare`: native beside h8, the servo's tick alone or whole boards on the line.
// SPDX-License-Identifier: Apache-2.0
#include "tools/mcu/compare.h"

#include <map>
#include <string>

#include <nlohmann/json.hpp>

#include "shared/base/counted.hpp"
#include "shared/protocol/message_info.h"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/base/paths.h"
#include "tools/base/provenance.h"

namespace kaz::tools {
namespace {

nlohmann::ordered_json to_json(const sim::CompareCoverage& coverage) {
  const auto counts = [](const std::map<std::uint8_t, std::int64_t>& by_code) {
    auto object = nlohmann::ordered_json::object();
    for (const auto& [code, count] : by_code) object[std::to_string(code)] = count;
    return object;
  };
  return {{"replies_by_type", counts(coverage.replies)},
          {"refusals_by_reason", counts(coverage.refusals)},
          {"replies_by_shutdown", counts(coverage.shutdowns)},
          {"actions", counts(coverage.actions)}};
}

nlohmann::ordered_json to_json(const sim::CompareReport& report) {
  nlohmann::ordered_json result{{"equal", report.equal()},
                                {"engine", report.engine},
                                {"instructions", report.instructions},
                                {"translated_instructions", report.translated_instructions},
                                {"ticks", report.ticks},
                                {"bytes_received", report.bytes_received},
                                {"bytes_sent", report.bytes_sent},
                                {"frames", report.frames_sent_to_board},
                                {"worst_tick_8states", report.worst_busy_8states},
                                {"missed_ticks", report.missed_ticks},
                                {"resets", report.resets},
                                {"pins_compared", report.pins_compared},
                                {"coverage", to_json(report.coverage)},
                                {"differences", nlohmann::ordered_json::array()}};
  if (report.tick) result["tick"] = *report.tick;
  if (!report.equal()) result["input_hex"] = report.input_hex;
  for (const auto& difference : report.differences) {
    result["differences"].push_back(
        {{"field", difference.field}, {"native", difference.native}, {"h8", difference.h8}});
  }
  return result;
}

nlohmann::ordered_json to_json(const sim::WireReport& report) {
  nlohmann::ordered_json result{{"equal", report.equal()},
                                {"seed", report.seed},
                                {"conversations", report.conversations},
                                {"different", report.different},
                                {"requests", report.requests},
                                {"fewest_requests", report.fewest_requests},
                                {"frames_back", report.replies},
                                {"bytes_at_txd0", report.bytes},
                                {"frames_with_fields_left_out", report.masked},
                                {"pins_compared_ms", report.pins_compared},
                                {"resets", report.resets},
                                {"largest_lag_states", report.largest_lag},
                                {"largest_reset_lag_states", report.largest_reset_lag},
                                {"h8_start_states", report.h8_start},
                                {"emulator_engine", report.emulator_engine},
                                {"chip_s", report.chip_s},
                                {"sent", report.kinds},
                                {"frames_back_by_type", nlohmann::ordered_json::object()},
                                {"differences", nlohmann::ordered_json::array()}};
  for (const auto& [type, count] : report.by_type) {
    const kz_message_info* info = kz_message_find(type);
    result["frames_back_by_type"][info ? info->name : std::to_string(type)] = count;
  }
  for (const auto& difference : report.differences) {
    result["differences"].push_back({{"conversation", difference.conversation},
                                     {"ms", difference.ms},
                                     {"what", difference.what},
                                     {"h8", difference.h8},
                                     {"native", difference.native},
                                     {"requests_before", difference.requests}});
  }
  return result;
}

template <class Report>
void print(const Report& report, bool json) {
  if (!json) return print_lines("%s\n", report.text().c_str());
  nlohmann::ordered_json result = to_json(report);
  if (report.stopped) mark_interrupted(result);
  result["provenance"] = provenance_json();
  print_json(result);
}

template <class Report>
Result<bool> ended(const Report& report, const std::string& covered) {
  if (!report.stopped) return report.equal();
  return fail(Fault::interrupted, "interrupted; the report covers " + covered);
}

}  // namespace

Result<bool> compare_ticks(sim::CompareOptions options, bool json) {
  auto image = KAZ_TRY(firmware_image(options.image_path));
  options.image_path = image;
  Progress progress("kaz mcu compare", json);
  options.progress = [&](std::int64_t done, std::int64_t total) {
    progress.update(static_cast<double>(done) / static_cast<double>(total), counted(done, "tick"));
  };
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  options.stop = [&interrupt] { return interrupt.requested(); };
  const auto report = sim::compare_engines(options);
  progress.done();
  if (!report) return tl::unexpected(report.error());
  print(*report, json);
  return ended(*report, counted(report->ticks, "tick"));
}

Result<bool> compare_on_wire(sim::WireOptions options, bool json) {
  auto image = KAZ_TRY(firmware_image(options.image_path));
  options.image_path = image;
  Progress progress("kaz mcu compare --wire", json);
  options.progress = [&](std::int64_t done, std::int64_t total) {
    progress.update(static_cast<double>(done) / static_cast<double>(total),
                    counted(done, "conversation"));
  };
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  options.stop = [&interrupt] { return interrupt.requested(); };
  const auto report = sim::compare_wire(options);
  progress.done();
  if (!report) return tl::unexpected(report.error());
  print(*report, json);
  return ended(*report, counted(report->conversations, "conversation"));
}

}  // namespace kaz::tools
