// The names of the table, their units, and what the project wants of them.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <ctime>
#include <utility>

#include "tools/bench/bench.h"

namespace kaz::bench {

const std::vector<Name>& names() {
  static const std::vector<Name> all{
      {"mcu.mips.crc", "M instr/s", 300, 1000, true, 0},
      {"mcu.mips.matrix", "M instr/s", 300, 1000, true, 0},
      {"mcu.mips.mix", "M instr/s", 300, 1000, true, 0},
      {"mcu.mips.firmware", "M instr/s", 0, 0, true, 0},
      {"mcu.mstates.crc", "M states/s", 0, 0, true, 0},
      {"mcu.mstates.matrix", "M states/s", 0, 0, true, 0},
      {"mcu.mstates.mix", "M states/s", 0, 0, true, 0},
      {"mcu.mstates.firmware", "M states/s", 0, 0, true, 0},
      {"mcu.host_per_guest.crc", "instr", 0, 0, false, 1},
      {"mcu.host_per_guest.matrix", "instr", 0, 0, false, 1},
      {"mcu.host_per_guest.mix", "instr", 0, 0, false, 1},
      {"mcu.host_per_guest.firmware", "instr", 0, 0, false, 1},
      {"mcu.firmware_x", "x real", 50, 200, true, 1},
      {"mcu.tick_worst", "% of tick", 75, 60, false, 1},
      {"mcu.tick_median", "% of tick", 45, 35, false, 1},
      {"wire.rate_hz", "Hz", 100, 0, true, 1},
      {"wire.share", "% of line", 60, 0, false, 1},
      {"loop.rtf", "x real", 4, 10, true, 1},
      {"dynamics.step_us.walking", "us", 25, 12, false, 1},
      {"dynamics.step_us.alone.exact", "us", 0, 0, false, 1},
      {"dynamics.step_us.alone.quick8", "us", 0, 0, false, 1},
      {"dynamics.step_us.alone.quick20", "us", 0, 0, false, 1},
      {"dynamics.step_us.alone.quick50", "us", 0, 0, false, 1},
      {"dynamics.step_us.walking.exact", "us", 0, 0, false, 1},
      {"dynamics.step_us.walking.quick8", "us", 0, 0, false, 1},
      {"dynamics.step_us.walking.quick20", "us", 0, 0, false, 1},
      {"dynamics.step_us.walking.quick50", "us", 0, 0, false, 1},
      {"dynamics.step_us.props.exact", "us", 0, 0, false, 1},
      {"dynamics.step_us.props.quick8", "us", 0, 0, false, 1},
      {"dynamics.step_us.props.quick20", "us", 0, 0, false, 1},
      {"dynamics.step_us.props.quick50", "us", 0, 0, false, 1},
      {"dynamics.gap_um.walking.exact", "um", 0, 0, false, 1},
      {"dynamics.gap_um.walking.quick8", "um", 0, 0, false, 1},
      {"dynamics.gap_um.walking.quick20", "um", 0, 0, false, 1},
      {"dynamics.gap_um.walking.quick50", "um", 0, 0, false, 1},
      {"dynamics.track_mrad.walking.exact", "mrad", 0, 0, false, 1},
      {"dynamics.track_mrad.walking.quick8", "mrad", 0, 0, false, 1},
      {"dynamics.track_mrad.walking.quick20", "mrad", 0, 0, false, 1},
      {"dynamics.track_mrad.walking.quick50", "mrad", 0, 0, false, 1},
      {"dynamics.collision_us.alone", "us", 1, 0, false, 2},
      {"dynamics.collision_us.walking", "us", 1, 0, false, 2},
      {"dynamics.collision_us.props", "us", 3, 0, false, 2},
      {"view.pair_ms.320", "ms", 4, 1.2, false, 2},
      {"view.pair_ms.640", "ms", 11, 5, false, 2},
      {"view.sensor_ms.320", "ms", 1.5, 0.5, false, 2},
      {"view.sensor_ms.640", "ms", 6, 2, false, 2},
      {"view.real_pair_ms.320", "ms", 0, 0, false, 2},
      {"view.real_pair_ms.640", "ms", 0, 0, false, 2},
      {"vision.color_ms.320", "ms", 0.06, 0.02, false, 3},
      {"vision.color_ms.640", "ms", 0.25, 0.06, false, 3},
      {"vision.regions_ms.320", "ms", 0.3, 0.1, false, 3},
      {"vision.regions_ms.640", "ms", 2, 0.4, false, 3},
      {"vision.ball_ms.320", "ms", 0, 0, false, 3},
      {"vision.ball_ms.640", "ms", 0, 0, false, 3},
  };
  return all;
}

void Results::remark(const std::string& text) {
  if (std::find(remarks_.begin(), remarks_.end(), text) == remarks_.end()) remarks_.push_back(text);
}

std::optional<double> Results::get(std::string_view name) const {
  const auto found = values_.find(name);
  if (found == values_.end()) return std::nullopt;
  return found->second;
}

Group each_engine(std::vector<std::string> gives, PerEngine measure) {
  return {
      std::move(gives),
      [measure = std::move(measure)](const Settings& settings, Results& results) -> Result<void> {
        for (const auto& engine : settings.engines) {
          if (auto done = measure(settings, engine, results); !done) return done;
        }
        return {};
      }};
}

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 ? values[half] : (values[half - 1] + values[half]) / 2;
}

}  // namespace kaz::bench
