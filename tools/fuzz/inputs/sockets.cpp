// Sockets: published cameras at the reader, the control socket on both sides.
// SPDX-License-Identifier: Apache-2.0
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <thread>

#include <nlohmann/json.hpp>

#include "hil/bench/motor/stand.h"
#include "host/camera/published_camera.h"
#include "host/robot/control_socket.h"
#include "shared/base/bounded_json.hpp"
#include "shared/base/camera_stream.hpp"
#include "sim/runtime/serving/control_server.h"
#include "sim/runtime/serving/followed_clock.h"
#include "sim/stand/stand_commands.h"
#include "tools/base/time_lost.h"
#include "tools/fuzz/inputs/input.h"
#include "tools/fuzz/inputs/targets.h"

namespace kaz::fuzz {
namespace {

using Json = nlohmann::ordered_json;

sockaddr_un address_of(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
  return address;
}

// A socket to which each client gets the same bytes, and then the end. It reads nothing.
class Sender {
 public:
  Sender(const std::string& path, Bytes bytes)
      : path_(path), socket_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)), bytes_(bytes) {
    ::unlink(path.c_str());
    const sockaddr_un address = address_of(path);
    if (::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
        ::listen(socket_, 1) != 0) {
      std::perror(path.c_str());
      std::exit(3);
    }
    thread_ = std::thread([this] { serve(); });
  }
  ~Sender() {
    ::shutdown(socket_, SHUT_RDWR);  // wakes accept()
    thread_.join();
    ::close(socket_);
    ::unlink(path_.c_str());
  }
  Sender(const Sender&) = delete;
  Sender& operator=(const Sender&) = delete;

 private:
  void serve() {
    const int client = ::accept(socket_, nullptr, nullptr);
    if (client < 0) return;
    for (Bytes left = bytes_; !left.empty();) {
      const ssize_t sent = ::send(client, left.data(), left.size(), MSG_NOSIGNAL);
      if (sent <= 0) break;
      left = left.subspan(static_cast<std::size_t>(sent));
    }
    // What the client has sent is taken first: closing over it would be an error at its end.
    ::shutdown(client, SHUT_WR);
    char ignored[256];
    while (::recv(client, ignored, sizeof ignored, 0) > 0) {
    }
    ::close(client);
  }

  std::string path_;
  int socket_;
  Bytes bytes_;
  std::thread thread_;
};

// Pictures of more than this are skipped: what they cost is memory alone.
constexpr std::uint64_t kMostPixels = 100'000;

bool claims_too_much(Bytes bytes) {
  CameraStreamHeader header{};
  if (bytes.size() < sizeof header) return false;
  std::memcpy(&header, bytes.data(), sizeof header);
  return std::uint64_t{header.width} * header.height > kMostPixels;
}

bool valid(const vision::CameraModel& c) {
  return c.width >= 1 && c.height >= 1 && std::isfinite(c.fx) && c.fx > 0 && std::isfinite(c.fy) &&
         c.fy > 0 && std::isfinite(c.cx) && std::isfinite(c.cy) && std::isfinite(c.baseline_m);
}

// ---- The control socket

// One client: sends the bytes in pieces while the server polls, and returns all that comes back.
std::string converse(sim::ControlServer& server, const std::string& path, Bytes bytes) {
  const int client = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const sockaddr_un address = address_of(path);
  std::string replies;
  if (::connect(client, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) {
    int quiet = 0;
    while (quiet < 3) {
      if (!bytes.empty()) {
        const std::size_t piece = std::min<std::size_t>(bytes.size(), 300);
        const ssize_t sent = ::send(client, bytes.data(), piece, MSG_NOSIGNAL | MSG_DONTWAIT);
        bytes = sent > 0 ? bytes.subspan(static_cast<std::size_t>(sent)) : Bytes{};
      }
      server.poll();
      char buffer[4096];
      const ssize_t got = ::recv(client, buffer, sizeof buffer, MSG_DONTWAIT);
      if (got > 0) replies.append(buffer, static_cast<std::size_t>(got));
      quiet = got > 0 || !bytes.empty() ? 0 : quiet + 1;
    }
  }
  ::close(client);
  server.poll();
  return replies;
}

// Whole lines, each an object with "ok", and with "error" where that is false.
Complaint judge_replies(const std::string& replies, std::size_t max_lines) {
  std::size_t lines = 0;
  for (std::size_t at = 0; at < replies.size(); ++lines) {
    const std::size_t end = replies.find('\n', at);
    if (end == std::string::npos) return "a reply has no newline at its end";
    const Json reply = parse_bounded_json<Json>(replies.substr(at, end - at)).value_or(nullptr);
    if (!reply.is_object() || !reply.contains("ok") || !reply["ok"].is_boolean())
      return "an invalid reply: " + replies.substr(at, end - at);
    if (!reply["ok"].get<bool>() && (!reply.contains("error") || !reply["error"].is_string() ||
                                     reply["error"].get<std::string>().empty()))
      return "a refusal without a reason";
    at = end + 1;
  }
  if (lines > max_lines) return "more replies than requests";
  return std::nullopt;
}

sim::ControlCommands::Handlers handlers_of(sim::Simulation& simulation) {
  return {.reset = [&] { simulation.board().reset(); },
          .boot_pins = [&](bool boot) { return simulation.board().set_boot_pins(boot); },
          .power = [&](bool on) { simulation.board().set_power(on); },
          .plug = [](bool) { return Result<void>{}; },
          .status =
              [&] {
                return Json{{"time_s", 1e-9 * static_cast<double>(simulation.time().count())}};
              },
          .watch_touches = [&] { simulation.world().watch_contacts(true); },
          .fault = [&](const faults::Fault& fault) { simulation.add_fault(fault); },
          .clear_faults = [&] { simulation.clear_faults(); },
          .now = [&] { return simulation.time(); },
          .stand = [&](const std::string& line) { return sim::answer_stand(simulation, line); }};
}

}  // namespace

Complaint try_camera_stream(Bytes bytes) {
  if (claims_too_much(bytes)) return std::nullopt;
  const std::string path = input_folder() + "/eyes";
  const Sender sender(path, bytes);
  const auto camera = host::PublishedCamera::connect(path);
  if (!camera) return judge_error(camera.error(), path, Fault::environment);
  if (!valid((*camera)->model())) return "an invalid camera model was read";
  if ((*camera)->latency() < Time::zero()) return "a negative latency was read";
  // Until the end of the stream, or for pairs that are of a later time.
  for (int k = 0; k < 50; ++k) {
    const auto pair = (*camera)->poll();
    if (!pair) return judge_error(pair.error(), path, Fault::environment);
    if (!*pair) {
      std::this_thread::sleep_for(std::chrono::microseconds(100));
      continue;
    }
    const auto images = (*pair)->images.get();
    for (const vision::Image* image : {&images->left, &images->right}) {
      if (image->width != (*camera)->model().width ||
          image->rgb.size() != camera_picture_bytes(static_cast<std::uint32_t>(image->width),
                                                    static_cast<std::uint32_t>(image->height)))
        return "a picture has the wrong size";
    }
  }
  return std::nullopt;
}

Complaint try_clock(Bytes bytes) {
  sim::ClockStream whole, pieces;
  const bool accepted = whole.feed(bytes).has_value();
  bool all = true;
  std::optional<Time> before;
  for (std::size_t i = 0; i < bytes.size() && all; ++i) {
    all = pieces.feed(bytes.subspan(i, 1)).has_value();
    if (before && *pieces.latest() < *before) return "the clock went backward";
    before = pieces.latest();
  }
  if (all != accepted || pieces.latest() != whole.latest())
    return "the result differs if the bytes arrive one by one";
  if (before && *before < Time::zero()) return "a time before the start was read";
  return std::nullopt;
}

Complaint try_control(Bytes bytes) {
  sim::StandOptions stand;
  stand.motor = {.name = "case",
                 .stall_slope_nm_per_v = 0.2,
                 .friction_nm = 0.1,
                 .back_emf_nms_per_rad = 0.3,
                 .rotor_inertia_kgm2 = 1e-3,
                 .max_supply_v = 12};
  auto simulation = sim::make_stand({}, stand);
  if (!simulation) return "cannot create the motor stand: " + simulation.error().message;
  const std::string path = input_folder() + "/control";
  auto server = sim::ControlServer::open(path, sim::ControlCommands(handlers_of(**simulation)));
  if (!server) return "cannot open the control server: " + server.error().message;
  // A request that is longer than allowed is answered too, and ends the connection.
  const auto requests =
      static_cast<std::size_t>(std::count(bytes.begin(), bytes.end(), std::uint8_t{'\n'}));
  if (auto wrong = judge_replies(converse(**server, path, bytes), requests + 1)) return wrong;
  for (int k = 0; k < 5; ++k) {
    if (auto stepped = (*simulation)->step(); !stepped)
      return "the simulation has stopped: " + stepped.error().message;
  }
  for (const sim::JointState& joint : (*simulation)->world().joints()) {
    if (!std::isfinite(joint.angle) || !std::isfinite(joint.velocity))
      return "a joint's angle or velocity is not finite";
  }
  // Another client is served as ever.
  const std::string request = "status\n";
  const auto* first = reinterpret_cast<const std::uint8_t*>(request.data());
  if (converse(**server, path, {first, request.size()}).rfind("{\"ok\":true", 0) != 0)
    return "the next client is not served";
  return std::nullopt;
}

Complaint try_control_reply(Bytes bytes) {
  const std::string port = input_folder() + "/replies", path = port + ".ctl";
  // What `kaz` learns about a simulator behind a port. Both end at the first reply.
  host::Interrupt interrupt;
  {
    const Sender sender(path, bytes);
    const auto lost = tools::time_lost_behind(port, interrupt)();
    if (!lost) return judge_error(lost.error(), path, Fault::environment);
    if (*lost < Time::zero()) return "a negative lost time was read";
  }
  {
    const Sender sender(path, bytes);
    const std::string mcu = tools::simulated_mcu(port, interrupt);
    if (mcu.size() > bytes.size()) return "the name is longer than the reply";
  }
  std::string text;
  {
    const Sender sender(path, bytes);
    const auto reply = host::query_control_socket(path, "stand disc");
    if (!reply) return judge_error(reply.error(), path, Fault::environment);
    text = *reply;
  }
  if (text.find('\n') != std::string::npos) return "the reply has several lines";
  // As `kaz bench --stand ctl:PATH` uses it, and nothing may wait for ever.
  struct Waiting final : host::Clock {
    Time now() const override { return now_; }
    Result<void> sleep_until(Time t) override {
      longest_ = std::max(longest_, t - now_);
      now_ = t;
      return {};
    }
    Time now_{}, longest_{};
  } clock;
  hil::CommandStand stand(
      "case",
      hil::CommandStand::parsed([&](const std::string&) -> Result<std::string> { return text; }),
      clock);
  for (const Result<double>& number : {stand.disc_kgm2(), stand.scale_nm(0), stand.turn(0, 1.0)}) {
    if (number ? !std::isfinite(*number) : number.error().message.empty())
      return "an invalid reading, or an error without a message";
  }
  if (clock.longest_ > std::chrono::seconds(30)) return "the stand waited for more than 30 s";
  return std::nullopt;
}

}  // namespace kaz::fuzz
