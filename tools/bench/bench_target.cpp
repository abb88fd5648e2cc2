// An emulated board on the virtual motor stand, or one on a port.
// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/bench_target.h"
#include "sim/runtime/simulation/recording_tap.h"

#include <nlohmann/json.hpp>

#include "host/link/port_link.h"
#include "host/link/wall_clock.h"
#include "host/robot/control_socket.h"
#include "shared/base/bounded_json.hpp"
#include "tools/base/arguments.h"
#include "tools/base/prompt.h"
#include "tools/base/time_lost.h"
#include "tools/lockstep/stand_backend.h"
#include "tools/run/line_recorder.h"

namespace kaz::tools {
namespace {

class VirtualTarget final : public BenchTarget {
 public:
  VirtualTarget(std::unique_ptr<sim::Simulation> simulation, sim::McuKind mcu,
                const host::Interrupt& interrupt)
      : name_(std::string("virtual board (") + to_string(mcu) + ")"),
        backend_(std::move(simulation), 0.1, &interrupt) {}
  std::string name() const override { return name_; }
  host::Link& link() override { return backend_.link(); }
  host::Clock& clock() override { return backend_.clock(); }
  hil::Stand* stand() override { return &backend_.stand(); }
  host::LatenessMeter* lateness() override { return nullptr; }

 private:
  std::string name_;
  lockstep::StandBackend backend_;
};

class PortTarget final : public BenchTarget {
 public:
  PortTarget(std::unique_ptr<host::PortLink> link, host::Interrupt& interrupt)
      : link_(std::move(link)),
        clock_(&interrupt),
        meter_(*link_, clock_, time_lost_behind(link_->name(), interrupt)) {}
  Result<void> show(sim::MessageTap* tap) {
    tapped_ = KAZ_TRY(LineRecorder::create("", {}, clock_, tap));
    shown_ = tapped_->record(meter_, 0);
    return {};
  }
  std::string name() const override { return link_->name(); }
  host::Link& link() override { return shown_ != nullptr ? *shown_ : meter_; }
  host::Clock& clock() override { return meter_; }
  hil::Stand* stand() override { return stand_.get(); }
  host::LatenessMeter* lateness() override { return &meter_; }
  host::LatenessMeter& meter() { return meter_; }
  void put(std::unique_ptr<hil::Stand> stand) { stand_ = std::move(stand); }

 private:
  std::unique_ptr<host::PortLink> link_;
  host::WallClock clock_;
  host::LatenessMeter meter_;
  std::unique_ptr<LineRecorder> tapped_;  // of viewers
  host::Link* shown_ = nullptr;           // meter_, as they see it
  std::unique_ptr<hil::Stand> stand_;
};

Result<std::unique_ptr<hil::Stand>> make_stand(const BenchTargetOptions& options,
                                               host::LatenessMeter& clock,
                                               const host::Interrupt& interrupt) {
  std::unique_ptr<hil::Stand> stand;
  if (options.stand == "manual") {
    stand = std::make_unique<hil::ManualStand>(
        [&interrupt, &clock](const std::string& prompt) {
          auto line =
              prompt_user(prompt, interrupt, "--stand manual needs somebody at the keyboard");
          clock.waited();
          return line;
        },
        options.backend.disc_kgm2);
  } else if (options.stand.starts_with("ctl:")) {
    const std::string path = options.stand.substr(4);
    const auto query = hil::CommandStand::parsed([path, &interrupt](const std::string& line) {
      return host::query_control_socket(path, "stand " + line, &interrupt);
    });
    // Whether it is a stand: said before anything moves.
    KAZ_TRY(query("disc"));
    stand = std::make_unique<hil::CommandStand>(options.stand, query, clock);
  } else if (!options.stand.empty()) {
    return fail(Fault::usage,
                "--stand " + options.stand +
                    ": give ctl:PATH (the control socket of kaz sim --stand) or manual");
  }
  return stand;
}

Result<std::unique_ptr<BenchTarget>> open_virtual(const BenchTargetOptions& options,
                                                  const host::Interrupt& interrupt) {
  if (!options.stand.empty())
    return fail(Fault::usage,
                "--stand is only valid with --robot; the virtual board has its own stand");
  BackendOptions backend = options.backend;
  backend.stand = true;
  auto simulation = KAZ_TRY(make_simulation(backend, sim::FramePolicy::wait));
  return std::make_unique<VirtualTarget>(std::move(simulation), backend.mcu, interrupt);
}

}  // namespace

Result<std::unique_ptr<BenchTarget>> BenchTarget::open(const BenchTargetOptions& options,
                                                       host::Interrupt& interrupt) {
  if (options.port.empty()) return open_virtual(options, interrupt);
  const auto port = KAZ_TRY(parse_port(options.port));
  auto link = KAZ_TRY(host::open_port(port, &interrupt));
  auto target = std::make_unique<PortTarget>(std::move(link), interrupt);
  if (options.backend.tap != nullptr) KAZ_TRY(target->show(options.backend.tap));
  auto stand = KAZ_TRY(make_stand(options, target->meter(), interrupt));
  target->put(std::move(stand));
  return target;
}

}  // namespace kaz::tools
