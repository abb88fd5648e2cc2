// The names of the table, their units, and what the project wants of them.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <ctime>
#include <utility>

#include "tools/benchmark/benchmark.h"
#include "tools/benchmark/body/names.h"

namespace kaz::bench {

namespace {

// By load: of each stepper a step, its instructions, and how well it holds; finding contacts; loading and
// cloning; many worlds.
std::vector<Name> dynamics() {
  using sim::bench::name_of;
  std::vector<Name> names{{name_of("step_us", "walking"), "us", 16, 12, false, 1}};
  for (const std::string load : sim::bench::kLoads) {
    for (const auto& [what, unit] : {std::pair{"step_us", "us"},
                                     {"step_kinstr", "k instr"},
                                     {"gap_um", "um"},
                                     {"track_mrad", "mrad"}}) {
      for (const char* stepper : sim::bench::kSteppers)
        names.push_back({name_of(what, load, stepper), unit, 0, 0, false, 1});
    }
    const double due = load == "props" ? 3 : 1;
    names.push_back({name_of("collision_us", load), "us", due, 0, false, 2});
    names.push_back({name_of("collision_kinstr", load), "k instr", 0, 0, false, 2});
  }
  for (const char* load : sim::bench::kWorldLoads) {
    names.push_back({name_of("load_ms", load), "ms", 0, 0, false, 1});
    names.push_back({name_of("clone_us", load), "us", 100, 25, false, 1});
  }
  names.push_back({sim::bench::kWorldsUs, "us", 0, 0, false, 1});
  names.push_back({sim::bench::kWorldsX, "x one", 1.3, 0, false, 2});
  return names;
}

std::vector<Name> all_names() {
  std::vector<Name> all{
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
      {"mcu.firmware_x", "x real", 120, 200, true, 1},
      {"mcu.tick_worst", "% of tick", 75, 60, false, 1},
      {"mcu.tick_median", "% of tick", 45, 35, false, 1},
      {"wire.rate_hz", "Hz", 100, 0, true, 1},
      {"wire.share", "% of line", 60, 0, false, 1},
      {"flash.efficiency", "% of time", 85, 95, true, 1},
      {"plan.median_ms.grid", "ms", 10, 0, false, 2},
      {"plan.median_ms.ompl", "ms", 10, 0, false, 2},
      {"plan.p99_ms.grid", "ms", 50, 0, false, 1},
      {"plan.p99_ms.ompl", "ms", 50, 0, false, 1},
      {"plan.over.grid", "% of time", 5, 0, false, 1},
      {"plan.over.ompl", "% of time", 5, 0, false, 1},
      {"loop.rtf", "x real", 4, 10, true, 1},
      {"loop.catch_x.color.opengl", "x real", 0, 0, true, 1},
      {"loop.catch_x.color.raster", "x real", 7, 0, true, 1},
      {"loop.catch_x.all.opengl", "x real", 0, 0, true, 1},
      {"loop.catch_x.all.raster", "x real", 4, 0, true, 1},
      {"view.pair_ms.320", "ms", 4, 1.2, false, 2},
      {"view.pair_ms.640", "ms", 11, 5, false, 2},
      {"view.sensor_ms.320", "ms", 1.5, 0.5, false, 2},
      {"view.sensor_ms.640", "ms", 6, 2, false, 2},
      {"view.real_pair_ms.320", "ms", 0, 0, false, 2},
      {"view.real_pair_ms.640", "ms", 0, 0, false, 2},
      {"view.pair_ms.320.raster", "ms", 1, 0.8, false, 2},
      {"view.pair_ms.640.raster", "ms", 4, 3.5, false, 2},
      {"view.real_pair_ms.320.raster", "ms", 2.5, 1.5, false, 2},
      {"view.real_pair_ms.640.raster", "ms", 9, 5, false, 2},
      {"vision.color_ms.320", "ms", 0.06, 0.02, false, 3},
      {"vision.color_ms.640", "ms", 0.25, 0.06, false, 3},
      {"vision.regions_ms.320", "ms", 0.3, 0.1, false, 3},
      {"vision.regions_ms.640", "ms", 2, 0.4, false, 3},
      {"peer.opencv_color_ms.yuv.320", "ms", 0, 0, false, 3},
      {"peer.opencv_color_ms.yuv.640", "ms", 0, 0, false, 3},
      {"peer.opencv_color_ms.hsv.320", "ms", 0, 0, false, 3},
      {"peer.opencv_color_ms.hsv.640", "ms", 0, 0, false, 3},
      {"peer.opencv_regions_ms.320", "ms", 0, 0, false, 3},
      {"peer.opencv_regions_ms.640", "ms", 0, 0, false, 3},
      {"vision.ball_ms.320", "ms", 0, 0, false, 3},
      {"vision.ball_ms.640", "ms", 0, 0, false, 3},
      {"vision.depth_ms.320", "ms", 1.2, 0, false, 3},
      {"vision.depth_ms.640", "ms", 22, 11, false, 3},
      {"peer.opencv_stereobm_ms.320", "ms", 0, 0, false, 3},
      {"peer.opencv_stereobm_ms.640", "ms", 0, 0, false, 3},
      {"vision.psf_ms.320", "ms", 0.8, 0.36, false, 3},
      {"vision.psf_ms.640", "ms", 3, 1.4, false, 3},
      {"vision.edges_ms.320", "ms", 0, 0, false, 3},
      {"vision.edges_ms.640", "ms", 0, 0, false, 3},
      {"vision.map_ms.320", "ms", 0.5, 0, false, 3},
      {"vision.map_ms.640", "ms", 0, 0, false, 3},
      {"vision.pipeline_ms.320", "ms", 3.5, 2.5, false, 3},
      {"vision.pipeline_ms.640", "ms", 0, 0, false, 3},
      {"vision.flow_ms.320", "ms", 0.8, 0.55, false, 3},
      {"vision.flow_ms.640", "ms", 4, 2.7, false, 3},
      {"vision.moving_ms.320", "ms", 0, 0, false, 3},
      {"vision.moving_ms.640", "ms", 0, 0, false, 3},
      {"peer.opencv_dis_ms.320", "ms", 0, 0, false, 3},
      {"peer.opencv_dis_ms.640", "ms", 0, 0, false, 3},
  };
  const auto view = std::find_if(all.begin(), all.end(),
                                 [](const Name& name) { return name.name == "view.pair_ms.320"; });
  const std::vector<Name> body = dynamics();
  all.insert(view, body.begin(), body.end());
  return all;
}

}  // namespace

const std::vector<Name>& names() {
  static const std::vector<Name> all = all_names();
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
