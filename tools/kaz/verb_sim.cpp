// `kaz sim`: a virtual robot for other processes.
// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <cstdio>
#include <thread>

#include <poll.h>

#include "sim/mcu/memory_file.h"
#include "sim/runtime/serving/real_time.h"
#include "sim/stand/stand_commands.h"
#include "tools/figure/figure.h"
#include "tools/kaz/interrupt_signals.h"
#include "tools/kaz/sim_options.h"
#include "tools/kaz/verbs.h"

namespace kaz::tools {
namespace {

struct SimArguments {
  BackendOptions backend;
  sim::RealTimeOptions real_time;
  std::string memory;       // file of the board's flash; none if empty
  bool boot = false;        // the mode pins ask for boot mode
  std::string calibration;  // file to write the eyes' calibration to; none if empty
};

// Sets a flag when the interrupt comes, for code that looks at a flag and not at a descriptor.
class StopFlag {
 public:
  explicit StopFlag(host::Interrupt& interrupt)
      : interrupt_(interrupt), thread_([this] {
          pollfd watched{interrupt_.descriptor(), POLLIN, 0};
          while (poll(&watched, 1, -1) < 0) continue;
          stop_ = true;
        }) {}
  ~StopFlag() {
    interrupt_.request();
    thread_.join();
  }
  const std::atomic<bool>& flag() const { return stop_; }

 private:
  host::Interrupt& interrupt_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

Result<bool> serve(SimArguments arguments) {
  if ((arguments.backend.erased || arguments.boot) && arguments.backend.engine != "h8")
    return fail(Fault::usage, "--erased and --boot are for --mcu h8: native has no flash");
  if (arguments.backend.erased && !arguments.backend.image.empty())
    return fail(Fault::usage, "--erased and --image exclude each other");
  auto simulation = make_simulation(arguments.backend, sim::FramePolicy::drop);
  if (!simulation) return tl::unexpected(simulation.error());
  if (!arguments.real_time.cameras_path.empty() && !(*simulation)->has_eyes())
    return tl::unexpected(sim::Simulation::no_eyes());
  if (!arguments.calibration.empty()) {
    if (!(*simulation)->has_eyes()) return tl::unexpected(sim::Simulation::no_eyes());
    const std::string text = (*simulation)->camera().calibration().yaml();
    const auto written = figure::write_file(
        arguments.calibration, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    if (!written) return tl::unexpected(written.error());
    if (arguments.real_time.serial_path.empty()) return true;
  }
  if (arguments.real_time.serial_path.empty())
    return fail(Fault::usage, "--serial is missing: where to put the link to the board's port");
  sim::Mcu& mcu = (*simulation)->board().mcu();
  if (!arguments.memory.empty()) {
    if (auto loaded = sim::load_memory(mcu, arguments.memory); !loaded)
      return tl::unexpected(loaded.error());
    mcu.reset();
  }
  if (arguments.boot) {
    if (auto set = mcu.set_boot_pins(true); !set) return tl::unexpected(set.error());
    mcu.reset();
  }
  if (arguments.backend.stand) {
    arguments.real_time.stand = [&s = **simulation](const std::string& line) {
      return sim::answer_stand(s, line);
    };
  }
  arguments.real_time.keep_hung = arguments.boot || arguments.backend.erased;
  arguments.real_time.report = [](const std::string& line) {
    std::printf("%s\n", line.c_str());
    std::fflush(stdout);
  };
  auto server = sim::RealTimeServer::open(**simulation, arguments.real_time);
  if (!server) return tl::unexpected(server.error());
  std::printf("ready: servo board (%s) on %s, control on %s.ctl%s%s; Ctrl-C ends\n",
              arguments.backend.engine.c_str(), arguments.real_time.serial_path.c_str(),
              arguments.real_time.serial_path.c_str(),
              arguments.real_time.cameras_path.empty() ? "" : ", cameras on ",
              arguments.real_time.cameras_path.c_str());
  std::fflush(stdout);
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  const StopFlag stop(interrupt);
  const auto statistics = (*server)->run(stop.flag());
  const auto recorded = (*simulation)->finish_recording();
  if (!statistics) return tl::unexpected(statistics.error());
  if (!recorded) return tl::unexpected(recorded.error());
  if (!arguments.memory.empty()) {
    if (auto saved = sim::save_memory(mcu, arguments.memory); !saved)
      return tl::unexpected(saved.error());
  }
  std::printf("ended after %.1f s; overruns %llu, worst %.1f ms late, pairs dropped %llu\n",
              statistics->simulated_s, static_cast<unsigned long long>(statistics->overruns),
              1e3 * statistics->worst_late_s,
              static_cast<unsigned long long>(statistics->pairs_dropped));
  if (const auto warning = (*simulation)->world().diagnostics().summary(); !warning.empty())
    std::printf("warning: %s\n", warning.c_str());
  if (!recorded->empty())
    std::printf("recording %s  sha256 %s\n", arguments.backend.recording.c_str(),
                recorded->c_str());
  return true;
}

}  // namespace

void add_sim(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand(
      "sim", "a virtual robot in real time for other processes: pty, camera and control socket");
  auto arguments = std::make_shared<SimArguments>();
  verb->add_option("--serial", arguments->real_time.serial_path,
                   "where to put the link to the board's serial port (a pty)")
      ->type_name("PATH");
  verb->add_option("--cameras", arguments->real_time.cameras_path,
                   "where to publish the stereo pairs (a Unix socket)")
      ->type_name("PATH");
  verb->add_flag("--fast", arguments->real_time.fast, "as fast as the machine can, not real time");
  verb->add_option("--memory", arguments->memory,
                   "file that keeps the board's calibration and address from one run to the next")
      ->type_name("FILE");
  verb->add_flag("--erased", arguments->backend.erased,
                 "the board's flash is blank, as the chip comes from the factory (kaz flash)");
  verb->add_flag("--boot", arguments->boot, "the board's switch stands at boot mode");
  verb->add_option("--write-calibration", arguments->calibration,
                   "write the eyes' calibration as OpenCV does (YAML); without --serial, only that")
      ->type_name("FILE");
  verb->add_option("--record", arguments->backend.recording,
                   "record everything into this file (MCAP), from the start to Ctrl-C")
      ->type_name("FILE");
  verb->add_flag(
      "--stand", arguments->backend.stand,
      "a motor stand instead of a robot: each motor alone with a disc on its shaft, clamp, "
      "scale, weight and supply at PATH.ctl (kaz bench)");
  add_motor_options(*verb, arguments->backend);
  add_sim_options(*verb, arguments->backend);
  add_record_pictures(*verb, arguments->backend);
  verb->footer(
      "The link behaves as a port with a board at the other end. PATH.ctl takes commands: reset,\n"
      "mode boot, mode run, power off, power on, status, stand help, one a line. Ends with Ctrl-C "
      "and removes "
      "what it made.\n"
      "Examples:\n"
      "  kaz sim --serial board --cameras board.eyes\n"
      "  kaz sim --serial board --erased   (kaz flash puts a firmware into it)\n"
      "  kaz sim --serial board --stand   (kaz bench motor --port board --stand ctl:board.ctl)\n"
      "  kaz sim --eyes real --write-calibration eyes.yml\n"
      "  kaz sim --serial board --record run.mcap   (Foxglove, PlotJuggler and `mcap info` open "
      "it)\n"
      "  kaz run track-ball --robot serial:board --camera board.eyes   (elsewhere)");
  verb->callback([&action, arguments] { action = [arguments] { return serve(*arguments); }; });
}

}  // namespace kaz::tools
