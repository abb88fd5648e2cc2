// `kaz sim`: a virtual robot for other processes.
// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/serve.h"

#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>

#include <nlohmann/json.hpp>

#include "sim/mcu/memory_file.h"
#include "sim/runtime/serving/real_time.h"
#include "sim/stand/stand_commands.h"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output_file.h"
#include "tools/run/robot_joints.h"
#include "tools/sim/stop_flag.h"

namespace kaz::tools {
namespace {

// Of links, sockets and files at one place the last would replace the others.
Result<void> check_distinct(const ServeOptions& arguments) {
  const std::string& serial = arguments.real_time.serial_path;
  const std::pair<const char*, std::string> all[] = {
      {"--serial", serial},
      {"the control socket of --serial", serial.empty() ? "" : serial + ".ctl"},
      {"--cameras", arguments.real_time.cameras_path},
      {"--clock", arguments.real_time.clock_path},
      {"--record", arguments.backend.recording},
      {"--memory", arguments.memory},
      {"--write-calibration", arguments.calibration}};
  std::map<std::filesystem::path, const char*> places;
  for (const auto& [what, path] : all) {
    if (path.empty()) continue;
    const auto [at, added] =
        places.emplace(std::filesystem::absolute(path).lexically_normal(), what);
    if (!added)
      return fail(Fault::usage, std::string(what) + ": '" + path + "' is also the path of " +
                                    at->second + "; give another path");
  }
  return {};
}

}  // namespace

Result<void> check_place(const std::string& option, const std::string& path) {
  if (path.empty()) return {};
  std::error_code error;
  const auto folder = std::filesystem::absolute(path, error).parent_path();
  if (std::filesystem::is_directory(folder, error)) return {};
  return fail(Fault::usage, option + ": cannot create " + path + " (there is no folder " +
                                folder.string() + "); give another path");
}

Result<bool> serve(ServeOptions arguments) {
  if (!arguments.backend.stand) print_unused("kaz sim", files_of(arguments.backend));
  if ((arguments.backend.erased || arguments.boot) && arguments.backend.mcu != sim::McuKind::h8)
    return fail(Fault::usage,
                "--erased and --boot are only valid with --mcu h8: native has no flash");
  if (arguments.backend.erased && !arguments.backend.image.empty())
    return fail(Fault::usage, "--erased is not valid with --image; leave out --erased or --image");
  KAZ_TRY(check_distinct(arguments));
  KAZ_TRY(check_place("--serial", arguments.real_time.serial_path));
  KAZ_TRY(check_place("--cameras", arguments.real_time.cameras_path));
  KAZ_TRY(check_place("--clock", arguments.real_time.clock_path));
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  std::optional<OutputFile> calibration, recording, memory;
  if (!arguments.calibration.empty())
    calibration = KAZ_TRY(OutputFile::open(arguments.calibration, "--write-calibration"));
  if (!arguments.backend.recording.empty()) {
    recording = KAZ_TRY(OutputFile::open(arguments.backend.recording, "--record"));
    arguments.backend.recording = recording->part();
  }
  if (!arguments.memory.empty()) memory = KAZ_TRY(OutputFile::open(arguments.memory, "--memory"));
  auto simulation = KAZ_TRY(make_simulation(arguments.backend, sim::FramePolicy::drop));
  if (!arguments.real_time.cameras_path.empty() && !simulation->has_eyes())
    return tl::unexpected(sim::Simulation::no_eyes());
  if (calibration) {
    if (!simulation->has_eyes()) return tl::unexpected(sim::Simulation::no_eyes());
    KAZ_TRY(calibration->write(simulation->camera().calibration().yaml()));
    std::printf("written: %s\n", calibration->path().c_str());
    if (arguments.real_time.serial_path.empty()) return true;
  }
  if (arguments.real_time.serial_path.empty())
    return fail(Fault::usage, "--serial is missing; give a path for the link to the board's port");
  sim::Mcu& mcu = simulation->board().mcu();
  if (memory) {
    KAZ_TRY(sim::load_memory(mcu, arguments.memory));
    mcu.reset();
  }
  if (arguments.boot) {
    KAZ_TRY(mcu.set_boot_pins(true));
    mcu.reset();
  }
  if (arguments.backend.stand) {
    arguments.real_time.stand = [&s = *simulation](const std::string& line) {
      return sim::answer_stand(s, line);
    };
  }
  arguments.real_time.keep_hung = arguments.boot || arguments.backend.erased;
  arguments.real_time.report = [](const std::string& line) {
    std::printf("%s\n", line.c_str());
    std::fflush(stdout);
  };
  auto server = KAZ_TRY(sim::RealTimeServer::open(*simulation, arguments.real_time));
  std::printf("ready: servo board (%s) on %s, control on %s.ctl%s%s; Ctrl-C ends\n",
              to_string(arguments.backend.mcu), arguments.real_time.serial_path.c_str(),
              arguments.real_time.serial_path.c_str(),
              arguments.real_time.cameras_path.empty() ? "" : ", cameras on ",
              arguments.real_time.cameras_path.c_str());
  std::fflush(stdout);
  const StopFlag stop(interrupt);
  const auto statistics = server->run(stop.flag());
  const auto recorded = simulation->finish_recording();
  if (recorded && recording) KAZ_TRY(recording->commit());
  // First the recording: that it cannot be written ends the simulation, too.
  if (!recorded) return tl::unexpected(recording ? recording->failure() : recorded.error());
  if (!statistics) return tl::unexpected(statistics.error());
  if (memory) {
    KAZ_TRY(sim::save_memory(mcu, memory->part()));
    KAZ_TRY(memory->commit());
  }
  std::printf(
      "ended after %.1f s; overruns: %llu, largest delay: %.1f ms, dropped pairs of pictures: "
      "%llu\n",
      statistics->simulated_s, static_cast<unsigned long long>(statistics->overruns),
      1e3 * statistics->worst_late_s, static_cast<unsigned long long>(statistics->pairs_dropped));
  if (const auto later = simulation->faults().not_begun(simulation->time()); !later.empty())
    std::printf("%s\n", faults::not_begun_text(later).c_str());
  if (const auto warning = simulation->world().diagnostics().summary(); !warning.empty())
    std::printf("warning: %s\n", warning.c_str());
  if (!recorded->empty())
    std::printf("recording %s  sha256 %s\n", recording->path().c_str(), recorded->c_str());
  return true;
}

}  // namespace kaz::tools
