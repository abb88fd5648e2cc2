// The loop of `kaz sim --bus`: up to the present, bytes in, bytes out, wait.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/serving/bus_server.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "sim/runtime/serving/bus_commands.h"
#include "sim/runtime/serving/control_server.h"
#include "sim/runtime/serving/pacer.h"
#include "sim/runtime/serving/pty.h"
#include "sim/runtime/serving/wall_time.h"

namespace kaz::sim {
namespace {

constexpr Time kTolerance = std::chrono::milliseconds(20);
constexpr Time kStep = std::chrono::milliseconds(1);
constexpr std::size_t kUsbPacket = 64;      // bytes that an adapter hands on at once
constexpr std::size_t kAdapterBytes = 256;  // that it takes before it blocks its writer
// Time for which bytes may still arrive from a host that has closed the port.
constexpr Time kEchoOfAHost = std::chrono::milliseconds(50);

}  // namespace

struct BusServer::Parts {
  Parts(VirtualBus& b, const BusServerOptions& o) : bus(b), options(o) {}

  void say(const std::string& text) const {
    if (options.report) options.report(text);
  }
  void notice_host();
  void host_to_bus();
  void bus_to_host();
  void report_overrun();
  Time wake() const;
  nlohmann::ordered_json status() const;

  VirtualBus& bus;
  BusServerOptions options;
  Pacer pacer{kTolerance};
  BusServerStatistics statistics;
  // The control socket first: opening it fails if another simulator serves the same paths.
  std::unique_ptr<ControlServer> control;
  std::unique_ptr<Pty> pty;
  bool present = false, losing = false;
  long rate = 0;
  Time discard_until{}, reported_at{}, last_byte{};
  std::uint64_t reported_overruns = 0;
};

Result<std::unique_ptr<BusServer>> BusServer::open(VirtualBus& bus,
                                                   const BusServerOptions& options) {
  auto parts = std::make_unique<Parts>(bus, options);
  Parts* p = parts.get();
  // A control socket that nobody serves (else opening fails) was left by a killed simulator, and so was the
  // link beside it.
  std::error_code none;
  const std::string control_path = options.serial_path + ".ctl";
  const bool left_over =
      std::filesystem::is_socket(std::filesystem::symlink_status(control_path, none));
  const BusCommands commands(bus, [p] { return p->status(); });
  parts->control = KAZ_TRY(ControlServer::open(
      control_path, [commands](std::string_view line) { return commands.answer(line); }));
  parts->pty = KAZ_TRY(Pty::open(options.serial_path, left_over));
  return std::unique_ptr<BusServer>(new BusServer(std::move(parts)));
}

BusServer::BusServer(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
BusServer::~BusServer() = default;

Result<BusServerStatistics> BusServer::run(const std::atomic<bool>& stop) {
  Parts& p = *parts_;
  const Time begin = p.bus.time();
  Time next_step = begin + kStep;
  p.pacer.start(begin, monotonic_now());
  while (!stop) {
    // Up to the present, step by step: a late bus catches up, or gives the time up.
    while (monotonic_now() >= p.pacer.wall_of(next_step)) {
      p.bus.advance(next_step);
      (void)p.pacer.step_done(next_step, monotonic_now());
      next_step += kStep;
      if (const std::string& failure = p.bus.world().diagnostics().failure; !failure.empty())
        return fail(Fault::failed, failure);
    }
    p.bus.advance(std::min(
        next_step,
        p.bus.time() + std::max(Time(0), monotonic_now() - p.pacer.wall_of(p.bus.time()))));
    p.control->poll();
    p.report_overrun();
    p.notice_host();
    p.host_to_bus();
    p.bus_to_host();
    const Time wait = p.pacer.wall_of(std::min(next_step, p.wake())) - monotonic_now();
    if (wait > Time(0)) p.pty->wait(wait, p.present);
  }
  p.statistics.simulated_s = seconds(p.bus.time() - begin);
  p.statistics.overruns = p.pacer.overruns();
  p.statistics.lost_s = seconds(p.pacer.lost());
  p.statistics.worst_late_s = seconds(p.pacer.worst_late());
  return p.statistics;
}

// When something on the wire is over.
Time BusServer::Parts::wake() const {
  const Time busy = bus.line().busy_until();
  return busy > bus.time() ? busy : Time::max();
}

void BusServer::Parts::notice_host() {
  const bool now_present = pty->host_present();
  if (now_present != present) {
    present = now_present;
    losing = false;
    say("host " + std::string(present ? "opened " : "closed ") + options.serial_path);
    rate = 0;
  }
  if (present) {
    discard_until = bus.time() + kEchoOfAHost;
  } else if (bus.time() < discard_until) {
    pty->discard_unread();
  }
}

void BusServer::Parts::host_to_bus() {
  const Time queued = bus.host_sends_until() - bus.time();
  if (seconds(queued) * static_cast<double>(std::max(rate, 1L)) / 10 > kAdapterBytes) return;
  std::array<std::uint8_t, kAdapterBytes> buffer;
  // A host that has closed the port may have left bytes.
  const std::size_t count = pty->read(buffer);
  if (count == 0) return;
  statistics.bytes_from_host += count;
  if (const long now = pty->rate(); now != rate) {
    rate = now;
    if (rate > 0) bus.set_host_baud(rate);
    say(rate > 0 ? "host sends at " + std::to_string(rate) + " baud"
                 : "host has hung up (0 baud): its bytes do not reach the bus");
  }
  if (rate <= 0) return;
  bus.write(std::span(buffer).first(count));
}

void BusServer::Parts::bus_to_host() {
  auto& received = bus.received();
  if (received.size() < kUsbPacket && bus.line().busy_until() > bus.time()) return;
  if (received.empty()) return;
  std::vector<std::uint8_t> bytes;
  for (const auto& byte : received) bytes.push_back(byte.byte);
  received.clear();
  // Without a host they are lost; a later host must not receive them.
  if (!present) return;
  const std::size_t taken = pty->write(bytes);
  statistics.bytes_to_host += taken;
  if (taken == bytes.size()) return;
  statistics.bytes_lost += bytes.size() - taken;
  if (!losing)
    say("host does not read " + options.serial_path + ": " + std::to_string(bytes.size() - taken) +
        " bytes from servos lost");
  losing = true;
}

// At most once per second: on a slow machine every step is late.
void BusServer::Parts::report_overrun() {
  if (pacer.overruns() == reported_overruns || bus.time() - reported_at < std::chrono::seconds(1))
    return;
  reported_overruns = pacer.overruns();
  reported_at = bus.time();
  say("overrun: the bus fell " + std::to_string(pacer.lost().count() / 1'000'000) +
      " ms behind the wall clock in " + std::to_string(reported_overruns) +
      (reported_overruns == 1 ? " stall" : " stalls"));
}

nlohmann::ordered_json BusServer::Parts::status() const {
  return {{"time_s", seconds(bus.time())},
          {"host", present},
          {"baud", rate},
          {"bytes_from_host", statistics.bytes_from_host},
          {"bytes_to_host", statistics.bytes_to_host},
          {"bytes_lost", statistics.bytes_lost},
          {"overruns", pacer.overruns()},
          {"lost_s", seconds(pacer.lost_until(bus.time(), monotonic_now()))},
          {"worst_late_s", seconds(pacer.worst_late())}};
}

}  // namespace kaz::sim
