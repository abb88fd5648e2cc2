// A behaviour from start to end, as `kaz run` has it.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/behavior.h"

#include <chrono>
#include <future>
#include <mutex>

#include "python/src/arguments.h"
#include "tools/app/session/session.h"

namespace kaz::python {
namespace {

// The interrupt of the session that runs, for as long as it is there.
class Stop {
 public:
  void begin(host::Interrupt* of_session) {
    const std::lock_guard lock(mutex_);
    interrupt_ = of_session;
  }
  void request() {
    const std::lock_guard lock(mutex_);
    if (interrupt_ != nullptr) interrupt_->request();
  }

 private:
  std::mutex mutex_;
  host::Interrupt* interrupt_ = nullptr;
};

// A backend whose end, before that of the session's interrupt, is known to `stop`.
class StoppableBackend final : public tools::SessionBackend {
 public:
  StoppableBackend(std::unique_ptr<SessionBackend> backend, Stop& stop)
      : backend_(std::move(backend)), stop_(stop) {}
  ~StoppableBackend() override { stop_.begin(nullptr); }
  std::vector<host::RobotBoard> boards() override { return backend_->boards(); }
  host::Clock& clock() override { return backend_->clock(); }
  const host::PortLink* port() const override { return backend_->port(); }
  Result<void> open_camera() override { return backend_->open_camera(); }
  bool sees() const override { return backend_->sees(); }
  vision::Camera& camera() override { return backend_->camera(); }
  std::string camera_warning() const override { return backend_->camera_warning(); }
  vision::Pace pace() const override { return backend_->pace(); }
  Time camera_latency() const override { return backend_->camera_latency(); }
  sim::Simulation* simulation() override { return backend_->simulation(); }
  std::vector<faults::Fault> faults_not_begun() const override {
    return backend_->faults_not_begun();
  }
  void record_behavior(const std::string& json) override { backend_->record_behavior(json); }
  void record_map(const sim::RecordedMap& map) override { backend_->record_map(map); }
  Result<std::string> finish_recording(const std::string& interrupted_by) override {
    return backend_->finish_recording(interrupted_by);
  }
  bool recording_failed() const override { return backend_->recording_failed(); }

 private:
  std::unique_ptr<SessionBackend> backend_;
  Stop& stop_;
};

// Python's values of options, as the command line has them: True is "true", 3.5 is "3.5".
std::map<std::string, std::string> settings_of(const py::dict& given) {
  std::map<std::string, std::string> settings;
  for (const auto& [name, value] : given) {
    const std::string text = py::isinstance<py::bool_>(value)
                                 ? (value.cast<bool>() ? "true" : "false")
                                 : std::string(py::str(value));
    settings[std::string(py::str(name))] = text;
  }
  return settings;
}

py::dict run_behavior(const std::string& name, const py::kwargs& given) {
  py::dict arguments(given);
  tools::SessionOptions session;
  session.backend = take_world_arguments(arguments);
  session.behavior = name;
  session.settings = settings_of(take<py::dict>(arguments, "settings", py::dict()));
  session.out = take<std::string>(arguments, "out", "");
  session.backend.robot = take<std::string>(arguments, "robot", "sim");
  session.backend.camera = take<std::string>(arguments, "camera", "sim");
  session.backend.calibration = take<std::string>(arguments, "calibration", "");
  session.backend.address = take<std::uint8_t>(arguments, "address", session.backend.address);
  session.backend.record_pictures = take<bool>(arguments, "record_pictures", false);
  nothing_left("run_behavior", arguments);
  session.quiet = true;
  session.json = true;  // no progress
  session.label = "kaz.run_behavior";
  session.backend.needs_camera = value_of(behavior::find_behavior(name)).needs_camera;

  std::optional<Result<behavior::Outcome>> ended;
  double duration_s = 0;
  session.on_end = [&](const Result<behavior::Outcome>& outcome, double run_s, double) {
    ended = outcome;
    duration_s = run_s;
  };
  Stop stop;
  session.open_backend =
      [&](host::Interrupt& of_session) -> Result<std::unique_ptr<tools::SessionBackend>> {
    auto backend = KAZ_TRY(tools::SessionBackend::open(session.backend, of_session));
    stop.begin(&of_session);
    return std::make_unique<StoppableBackend>(std::move(backend), stop);
  };
  // In a thread of its own, so that signals reach this one.
  auto running = std::async(std::launch::async, [&session] { return tools::run_session(session); });
  bool interrupted = false;
  while (released([&] { return running.wait_for(std::chrono::milliseconds(50)); }) !=
         std::future_status::ready) {
    if (interrupted || PyErr_CheckSignals() == 0) continue;
    interrupted = true;
    PyErr_Clear();
    stop.request();
  }
  const auto result = running.get();
  if (interrupted) raise(host::Interrupt::error());
  if (!result) raise(result.error());

  py::dict report;
  report["success"] = *result;
  report["duration_s"] = duration_s;
  if (ended && *ended) {
    report["sentence"] = (*ended)->sentence;
    report["cause"] = (*ended)->cause;
    py::dict numbers;
    for (const auto& [what, number] : (*ended)->measurements) numbers[what.c_str()] = number;
    report["measurements"] = numbers;
  } else if (ended) {
    report["sentence"] = ended->error().message;
    report["cause"] = "error";
    report["measurements"] = py::dict();
  }
  return report;
}

py::dict behaviors() {
  py::dict all;
  for (const behavior::Behavior& one : behavior::behaviors()) {
    py::dict options;
    for (const behavior::Option& option : one.options)
      options[py::str(std::string(option.name))] = std::string(option.text);
    all[py::str(std::string(one.name))] = py::make_tuple(std::string(one.text), options);
  }
  return all;
}

}  // namespace

void add_behavior(py::module_& module) {
  module.def("run_behavior", &run_behavior, py::arg("name"));
  module.def("behaviors", &behaviors);
}

}  // namespace kaz::python
