// `kaz mcu compare --wire`.
// SPDX-License-Identifier: Apache-2.0
#include "tools/kaz/mcu_wire.h"

#include <cstdio>
#include <map>
#include <string>

#include <nlohmann/json.hpp>

#include "shared/protocol/message_info.h"
#include "tools/kaz/image_options.h"
#include "tools/kaz/output.h"
#include "tools/kaz/paths.h"
#include "tools/kaz/verbs.h"

namespace kaz::tools {
namespace {

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

}  // namespace

void add_wire_options(CLI::App& verb, WireArguments& arguments) {
  auto* wire = verb.add_flag("--wire", arguments.wire, "compare whole boards on the line instead");
  verb.add_option("--conversations", arguments.options.conversations,
                  "with --wire: of a second each")
      ->check(positive())
      ->capture_default_str()
      ->needs(wire);
  verb.add_option("--first", arguments.options.first, "with --wire: number of the first one")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str()
      ->needs(wire);
}

Result<bool> compare_on_wire(sim::WireOptions options, bool json) {
  auto image = firmware_image(options.image_path);
  if (!image) return tl::unexpected(image.error());
  options.image_path = *image;
  Progress progress("kaz mcu compare --wire", json);
  options.progress = [&](std::int64_t done, std::int64_t total) {
    progress.update(static_cast<double>(done) / static_cast<double>(total),
                    std::to_string(done) + " conversations");
  };
  const auto report = sim::compare_wire(options);
  progress.done();
  if (!report) return tl::unexpected(report.error());
  std::printf("%s\n", json ? to_json(*report).dump(2).c_str() : report->text().c_str());
  return report->equal();
}

}  // namespace kaz::tools
