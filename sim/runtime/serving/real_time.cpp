// The loop of `kaz sim`: bytes in, one step, bytes and pictures out, wait for the clock.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/serving/real_time.h"

#include <time.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "shared/protocol/message_info.h"
#include "shared/servo/fields.h"
#include "sim/body/description/robot_model.h"
#include "sim/mcu/h8_layout.h"
#include "sim/mcu/h8_mcu.h"
#include "sim/runtime/serving/camera_server.h"
#include "sim/runtime/serving/control_server.h"
#include "sim/runtime/serving/followed_clock.h"
#include "sim/runtime/serving/host_watch.h"
#include "sim/runtime/serving/pacer.h"
#include "sim/runtime/serving/pty.h"
#include "sim/runtime/serving/wall_time.h"

namespace kaz::sim {
namespace {

constexpr Time kTolerance = std::chrono::milliseconds(20);
// Time for which bytes may still arrive from a host that has closed the port.
constexpr Time kEchoOfAHost = std::chrono::milliseconds(50);
// Buffer size of a USB adapter, beyond which it blocks its writer.
constexpr std::size_t kAdapterBytes = 256;
// Between two looks at `stop` and the control socket while a followed clock stands still.
constexpr Time kLongestWait = std::chrono::milliseconds(50);

void sleep_for(Time length) {
  timespec t{static_cast<time_t>(length.count() / 1'000'000'000),
             static_cast<long>(length.count() % 1'000'000'000)};
  // A signal may end the wait early; the next step then waits longer.
  clock_nanosleep(CLOCK_MONOTONIC, 0, &t, nullptr);
}

std::string shutdown_words(std::uint32_t reason, std::uint32_t joint) {
  if (reason == KZ_SHUTDOWN_NONE) return "by a host request or by a reset";
  std::string words = std::string("shutdown, ") + kz_shutdown_text(static_cast<u8>(reason));
  if (joint < KZ_JOINTS) words += " (" + joint_names()[joint] + ")";
  return words;
}

}  // namespace

struct RealTimeServer::Parts {
  Parts(Simulation& s, const RealTimeOptions& o)
      : simulation(s), options(o), watch(o.serial_path, o.report) {}

  void keep_hung();
  // By the clock that paces the world.
  Time now() const { return clock ? clock->now() : monotonic_now(); }
  Result<void> wait(Time length, const std::atomic<bool>& stop);
  Result<void> wait_for_first_time(const std::atomic<bool>& stop);
  void host_to_board();
  void board_to_host();
  void pictures();
  void set_power(bool on);
  Result<void> plug(bool in);
  void report_overrun();
  std::string why_off() const;
  bool joints_held() const;
  nlohmann::ordered_json status() const;
  void watch_touches();
  void collect_touches();

  Simulation& simulation;
  RealTimeOptions options;
  HostWatch watch;
  Pacer pacer{kTolerance};
  Time overruns_reported_at{}, discard_until{};
  std::uint64_t overruns_reported = 0;
  bool motors_on = false;
  // Each pair of a link of the robot and something that is none, when it first touched it; null: not watched.
  nlohmann::ordered_json touched;
  // The control socket first: opening it fails if another simulator serves the same paths.
  std::unique_ptr<ControlServer> control;
  std::unique_ptr<Pty> pty;
  std::unique_ptr<CameraServer> cameras;
  std::unique_ptr<FollowedClock> clock;  // null: the wall clock
  // With a followed clock: pictures that the world waits for at a time, so that some of their latency is left
  // for the way to their reader.
  struct Drawing {
    Time until;
    decltype(vision::StereoPair::images) images;
  };
  std::deque<Drawing> drawing;
};

Result<std::unique_ptr<RealTimeServer>> RealTimeServer::open(Simulation& simulation,
                                                             const RealTimeOptions& options) {
  auto parts = std::make_unique<Parts>(simulation, options);
  Parts* p = parts.get();
  ControlCommands commands({
      .reset =
          [p] {
            p->simulation.board().reset();
            p->watch.board_restarted("reset by the control socket");
          },
      .boot_pins =
          [p](bool boot) {
            // While flashing the board may have no program.
            if (boot) p->keep_hung();
            return p->simulation.board().set_boot_pins(boot);
          },
      .power = [p](bool on) { p->set_power(on); },
      .plug = [p](bool in) { return p->plug(in); },
      .status = [p] { return p->status(); },
      .watch_touches = [p] { p->watch_touches(); },
      .fault = [p](const faults::Fault& fault) { p->simulation.add_fault(fault); },
      .clear_faults = [p] { p->simulation.clear_faults(); },
      .now = [p] { return p->simulation.time(); },
      .stand = options.stand,
  });
  // A control socket that nobody serves (else opening fails) was left by a killed simulator, and so was the
  // link beside it.
  std::error_code none;
  const std::string control_path = options.serial_path + ".ctl";
  const bool left_over =
      std::filesystem::is_socket(std::filesystem::symlink_status(control_path, none));
  auto control = KAZ_TRY(ControlServer::open(control_path, std::move(commands)));
  parts->control = std::move(control);
  auto pty = KAZ_TRY(Pty::open(options.serial_path, left_over));
  parts->pty = std::move(pty);
  if (!options.cameras_path.empty()) {
    auto cameras = KAZ_TRY(CameraServer::open(options.cameras_path, simulation.camera().model(),
                                              from_seconds(simulation.camera().latency_s)));
    parts->cameras = std::move(cameras);
  }
  if (!options.clock_path.empty()) {
    auto clock = KAZ_TRY(FollowedClock::open(options.clock_path));
    parts->clock = std::move(clock);
  }
  if (options.keep_hung) p->keep_hung();
  simulation.board().mcu().on_watchdog_reset([p](States) {
    p->watch.board_restarted(
        "reset by the watchdog: either a host requested the reset, or the firmware hung "
        "(`identify` "
        "reports the cause)");
  });
  return std::unique_ptr<RealTimeServer>(new RealTimeServer(std::move(parts)));
}

RealTimeServer::RealTimeServer(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}

RealTimeServer::~RealTimeServer() {
  parts_->simulation.board().mcu().on_watchdog_reset([](States) {});
  parts_->simulation.board().mcu().on_hang(nullptr);
  parts_->simulation.close_eyes();
}

Result<RealTimeStatistics> RealTimeServer::run(const std::atomic<bool>& stop) {
  Parts& p = *parts_;
  const Time begin = p.simulation.time();
  KAZ_TRY(p.wait_for_first_time(stop));
  p.pacer.start(begin, p.now());
  while (!stop) {
    p.control->poll();
    p.host_to_board();
    KAZ_TRY(p.simulation.step());
    p.collect_touches();
    p.board_to_host();
    p.pictures();
    if (p.options.fast) {
      p.pacer.start(p.simulation.time(), monotonic_now());
      continue;
    }
    const Time wait = p.pacer.step_done(p.simulation.time(), p.now());
    p.report_overrun();
    if (wait > Time::zero()) KAZ_TRY(p.wait(wait, stop));
  }
  return RealTimeStatistics{.simulated_s = seconds(p.simulation.time() - begin),
                            .overruns = p.pacer.overruns(),
                            .lost_s = seconds(p.pacer.lost()),
                            .worst_late_s = seconds(p.pacer.worst_late()),
                            .pairs_dropped = p.simulation.pairs_dropped()};
}

Result<void> RealTimeServer::Parts::wait(Time length, const std::atomic<bool>& stop) {
  if (!clock) {
    sleep_for(length);
    return {};
  }
  const Time end = clock->now() + length;
  while (!stop && clock->now() < end) {
    if (KAZ_TRY(
            clock->poll(kLongestWait))) {  // of another machine, or of one that was started again
      pacer.start(simulation.time(), clock->now());
      return {};
    }
    control->poll();
  }
  return {};
}

Result<void> RealTimeServer::Parts::wait_for_first_time(const std::atomic<bool>& stop) {
  while (clock && !stop) {
    if (KAZ_TRY(clock->poll(kLongestWait))) return {};
    control->poll();
  }
  return {};
}

void RealTimeServer::Parts::keep_hung() {
  simulation.board().mcu().on_hang([this](const std::string& hang) {
    if (options.report)
      options.report("board hangs until reset: " + hang.substr(0, hang.find('\n')));
  });
}

void RealTimeServer::Parts::host_to_board() {
  const Time now = simulation.time();
  const bool present = pty && pty->host_present();
  const long baud = present ? pty->baud() : 115200;
  watch.presence(now, present, baud);
  if (baud > 0) simulation.line().set_host_bit(KZ_CLOCK_HZ / baud);

  std::array<std::uint8_t, kAdapterBytes> buffer{};
  const std::size_t waiting = simulation.line().waiting(simulation.now());
  const std::size_t room = waiting < kAdapterBytes ? kAdapterBytes - waiting : 0;
  // A host that has closed the port may have left bytes.
  const std::size_t count = pty && room > 0 ? pty->read(std::span(buffer).first(room)) : 0;
  if (count > 0) {
    watch.bytes_came(now);
    const auto bytes = std::span<const std::uint8_t>(buffer).first(count);
    if (baud > 0) {
      simulation.line().write(bytes, simulation.now());
    } else {
      simulation.line().write_garbled(bytes, simulation.now());
    }
  }
  watch.check_silence(now);
  if (present) {
    discard_until = now + kEchoOfAHost;
  } else if (pty && now < discard_until) {
    pty->discard_unread();
  }
}

void RealTimeServer::Parts::board_to_host() {
  const bool enabled = simulation.board().drivers_enabled();
  // Looked up only when they go off.
  watch.drivers(simulation.time(), enabled, motors_on && !enabled ? why_off() : "");
  motors_on = enabled;
  if (enabled && watch.may_hold(simulation.time()) && joints_held()) watch.held(simulation.time());
  std::array<std::uint8_t, kAdapterBytes> buffer{};
  const std::size_t count = simulation.read(buffer);
  // Without a host the board's bytes are lost; a later host must not receive them.
  if (count == 0 || !watch.present()) return;
  const std::size_t taken = pty->write(std::span<const std::uint8_t>(buffer).first(count));
  if (taken < count) watch.bytes_lost(count - taken);
}

// Unplugged: a host with the port open gets a hang-up, as with a USB adapter; the board continues.
Result<void> RealTimeServer::Parts::plug(bool in) {
  if (!in) {
    pty.reset();
    if (options.report) options.report(options.serial_path + " is unplugged");
    return {};
  }
  if (pty) return {};
  auto opened = KAZ_TRY(Pty::open(options.serial_path));
  pty = std::move(opened);
  if (options.report) options.report(options.serial_path + " is plugged in");
  return {};
}

void RealTimeServer::Parts::pictures() {
  if (!cameras && !options.on_pair) return;
  const Time half_latency = from_seconds(simulation.camera().latency_s / 2);
  const bool watched = options.on_pair && options.wants_pairs && options.wants_pairs();
  if (watched || (cameras && cameras->readers() > 0)) {
    simulation.open_eyes();
  } else {
    simulation.close_eyes();
  }
  while (auto pair = simulation.next_exposed_pair()) {
    const Time exposure = pacer.wall_of(pair->info.exposure);
    if (clock) drawing.push_back({pair->info.exposure + half_latency, pair->images});
    if (watched) options.on_pair(*pair);
    if (cameras) cameras->publish(std::move(*pair), exposure);
  }
  // Drawing takes this machine's time, which the followed clock does not count.
  while (!drawing.empty() && drawing.front().until <= simulation.time()) {
    drawing.front().images.wait();
    drawing.pop_front();
  }
}

void RealTimeServer::Parts::set_power(bool on) {
  simulation.board().set_power(on);
  if (options.report) options.report(on ? "board's power is on" : "board's power is off");
}

// Fields of the firmware's state in the emulated chip's memory; nothing for an image without symbols.
std::optional<std::vector<std::uint32_t>> fields_of(const Mcu& mcu,
                                                    std::initializer_list<std::string_view> names) {
  const auto* h8 = dynamic_cast<const H8Mcu*>(&mcu);
  const auto state =
      h8 == nullptr ? std::vector<std::uint8_t>() : h8->global("kz_servo_state", kz_state_size_h8);
  if (state.empty()) return std::nullopt;
  std::vector<std::uint32_t> values;
  const std::span all(kz_state_fields, kz_state_field_count);
  for (const std::string_view name : names) {
    const auto field = std::ranges::find(
        all, name, [](const kz_state_field& one) { return std::string_view(one.name); });
    values.push_back(field == all.end() ? 0 : h8_layout::number(state, field->offset, field->size));
  }
  return values;
}

// From the firmware's state: the reason of a latched shutdown, and its joint.
std::string RealTimeServer::Parts::why_off() const {
  if (!simulation.board().power()) return "the board has no power";
  const Mcu& mcu = simulation.board().mcu();
  if (const kz_servo* servo = mcu.servo())
    return shutdown_words(servo->shutdown, servo->shutdown_detail);
  const auto fields = fields_of(mcu, {"shutdown", "shutdown_detail"});
  return fields ? shutdown_words(fields->at(0), fields->at(1)) : "";
}

bool RealTimeServer::Parts::joints_held() const {
  const Mcu& mcu = simulation.board().mcu();
  if (const kz_servo* servo = mcu.servo()) return servo->holding != 0;
  const auto fields = fields_of(mcu, {"holding"});
  return fields && fields->at(0) != 0;
}

// At most once per second: on a slow machine every step is late.
void RealTimeServer::Parts::report_overrun() {
  const Time now = simulation.time();
  if (pacer.overruns() == overruns_reported || now - overruns_reported_at < std::chrono::seconds(1))
    return;
  overruns_reported = pacer.overruns();
  overruns_reported_at = now;
  if (options.report)
    options.report("overrun: the world fell " + std::to_string(pacer.lost().count() / 1'000'000) +
                   " ms behind the wall clock in " + std::to_string(overruns_reported) +
                   (overruns_reported == 1 ? " stall" : " stalls"));
}

// Links in contact: force in N, centre of pressure in the link's frame, m.
nlohmann::ordered_json link_forces(const World& world) {
  auto links = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < world.link_forces().size(); ++i) {
    const LinkForce& link = world.link_forces()[i];
    if (!(link.pressure > 0)) continue;
    links[world.link_order()[i]] = {
        {"force_n", {link.force.x(), link.force.y(), link.force.z()}},
        {"centre_m", {link.centre.x(), link.centre.y(), link.centre.z()}}};
  }
  return links;
}

// World frame, m; null without a model `ball`.
nlohmann::ordered_json ball(const World& world) {
  const auto place = world.object_position("ball");
  if (!place) return nullptr;
  return {place->x(), place->y(), place->z()};
}

bool has_link(const World& world, const char* link) {
  return std::ranges::find(world.link_order(), link) != world.link_order().end();
}

// World frame: position, m; roll, pitch and yaw, rad. Null where it is not there, as of a motor stand.
nlohmann::ordered_json pose_of(const World& world, const char* link, bool is_there) {
  if (!is_there) return nullptr;
  const Eigen::Isometry3d pose = world.link_pose(link);
  const Eigen::Matrix3d& r = pose.linear();
  const Eigen::Vector3d at = pose.translation();
  return {{"position_m", {at.x(), at.y(), at.z()}},
          {"roll_pitch_yaw_rad",
           {std::atan2(r(2, 1), r(2, 2)), std::asin(std::clamp(-r(2, 0), -1.0, 1.0)),
            std::atan2(r(1, 0), r(0, 0))}}};
}

void RealTimeServer::Parts::watch_touches() {
  if (!touched.is_null()) return;
  touched = nlohmann::ordered_json::array();
  simulation.world().watch_contacts(true);
}

void RealTimeServer::Parts::collect_touches() {
  constexpr std::size_t kMost = 200;
  if (touched.is_null() || touched.size() >= kMost) return;
  const auto links = simulation.world().link_order();
  const auto robots = [&links](const std::string& name) {
    return std::ranges::find(links, name) != links.end();
  };
  for (const ContactPoint& contact : simulation.world().contacts()) {
    if (robots(contact.a) == robots(contact.b)) continue;
    const bool by_robot = robots(contact.b);
    const std::string& thing = by_robot ? contact.a : contact.b;
    const std::string& by = by_robot ? contact.b : contact.a;
    const bool known = std::ranges::any_of(touched, [&](const nlohmann::ordered_json& one) {
      return one["thing"] == thing && one["by"] == by;
    });
    if (!known)
      touched.push_back({{"thing", thing}, {"by", by}, {"at_s", seconds(simulation.time())}});
  }
}

nlohmann::ordered_json RealTimeServer::Parts::status() const {
  const ServoBoard& board = simulation.board();
  const Time lost = pacer.lost_until(simulation.time(), now());
  nlohmann::ordered_json json{{"time_s", seconds(simulation.time())},
                              {"mcu", board.mcu().name()},
                              {"power", board.power()},
                              {"boot_rom", board.mcu().in_boot_rom()},
                              {"motors", board.drivers_enabled()},
                              {"supply_volts", board.supply_volts()},
                              {"driver_celsius", board.driver_celsius()},
                              {"imu", board.imu().has_value()},
                              {"link_forces", link_forces(simulation.world())},
                              {"ball_m", ball(simulation.world())},
                              {"host", watch.present()},
                              {"camera_readers", cameras ? cameras->readers() : 0},
                              {"pairs_dropped", simulation.pairs_dropped()},
                              {"pairs_missed_by_readers", cameras ? cameras->missed() : 0},
                              {"overruns", pacer.overruns()},
                              {"lost_s", seconds(lost)},
                              {"worst_late_s", seconds(pacer.worst_late())}};
  const World& world = simulation.world();
  for (const char* link : {"trunk", "l_ankle_pitch", "r_ankle_pitch"})
    json[link] = pose_of(world, link, has_link(world, link));
  json["left_eye"] = pose_of(world, "left_eye", world.head_frame() >= 0);
  if (world.measures_convergence())
    json["unconverged_steps"] = world.diagnostics().unconverged_steps;
  if (!touched.is_null()) json["touched"] = touched;
  return json;
}

}  // namespace kaz::sim
