// `--view`: a run, live, for viewers.
// SPDX-License-Identifier: Apache-2.0
#include "tools/viewer/view.h"

#include <algorithm>
#include <filesystem>
#include <numbers>
#include <span>
#include <thread>
#include <utility>

#include <boost/asio/ip/address.hpp>
#include <nlohmann/json.hpp>

#include "shared/base/files.hpp"
#include "shared/base/number_text.hpp"
#include "sim/body/description/robot_model.h"
#include "sim/body/description/urdf_writer.h"
#include "tools/viewer/textures.h"

namespace kaz::viewer {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestFile = 64 << 20;
constexpr const char* kWithoutPage =
    ".\n"
    "Foxglove and Lichtblick can open the address that kaz printed, including the token: paste the "
    "address with ws:// instead of http://.\n";

const char* type_of(const fs::path& path) {
  const std::string end = path.extension().string();
  if (end == ".html") return "text/html; charset=utf-8";
  if (end == ".js") return "text/javascript";
  if (end == ".css") return "text/css";
  if (end == ".svg") return "image/svg+xml";
  if (end == ".png") return "image/png";
  if (end == ".urdf") return "application/xml";
  return "application/octet-stream";
}

Result<ServedFile> served(const fs::path& path) {
  const std::string bytes = KAZ_TRY(read_whole_file(path.string(), kLargestFile));
  return ServedFile{type_of(path), Bytes(bytes.begin(), bytes.end())};
}

// All of the page's folder, by "/path in it".
Result<std::map<std::string, ServedFile>> page_files(const fs::path& folder) {
  std::map<std::string, ServedFile> files;
  std::error_code error;
  for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end;
       at.increment(error)) {
    std::error_code ignored;
    if (!at->is_regular_file(ignored)) continue;
    files["/" + at->path().lexically_relative(folder).generic_string()] =
        KAZ_TRY(served(at->path()));
  }
  return files;
}

// The robot as URDF, and those of its meshes that are in its folder. Nothing else of that folder is served.
Result<std::map<std::string, ServedFile>> robot_files(const fs::path& robot,
                                                      const sim::RobotModel& model) {
  std::map<std::string, ServedFile> files;
  const std::string urdf = KAZ_TRY(sim::robot_urdf(robot.string(), &model));
  files["/robot.urdf"] = files["/robot/" + robot.filename().generic_string()] =
      ServedFile{"application/xml", Bytes(urdf.begin(), urdf.end())};
  std::error_code error;
  const fs::path folder = fs::canonical(fs::absolute(robot).parent_path(), error);
  for (const sim::RobotLink& link : model.links) {
    for (const sim::Visual& visual : link.rigid.visuals) {
      if (visual.shape.kind != sim::Shape::Kind::mesh) continue;
      // Both paths are free of links, so that ".." is the only way out.
      const fs::path inside = fs::path(visual.shape.mesh_path).lexically_relative(folder);
      if (error || inside.empty() || *inside.begin() == "..") continue;
      files["/robot/" + inside.generic_string()] = KAZ_TRY(served(visual.shape.mesh_path));
    }
  }
  return files;
}

}  // namespace

bool lasts(std::string_view topic, std::span<const std::uint8_t> data) {
  // Poses as well: a run that pauses sends no others.
  if (topic.starts_with("/map") || topic == "/scene" || topic == "/robot_description" ||
      topic == "/tf")
    return true;
  const std::string_view text(reinterpret_cast<const char*>(data.data()), data.size());
  return topic == "/behavior" && text.find("\"phase\"") != std::string_view::npos;
}

Result<Where> parse_where(const std::string& text) {
  Where where;
  if (text.empty()) return where;
  const auto colon = text.rfind(':');
  const bool only_port = colon == std::string::npos;
  const auto port =
      parse_number<std::uint16_t>(std::string_view(text).substr(only_port ? 0 : colon + 1));
  if (!only_port) {
    where.address = text.substr(0, colon);
    if (where.address.starts_with('[') && where.address.ends_with(']'))
      where.address = where.address.substr(1, where.address.size() - 2);
  }
  boost::system::error_code error;
  (void)boost::asio::ip::make_address(where.address, error);
  if (!port || error)
    return fail(Fault::usage, "--view " + text +
                                  ": give a port, or a numeric address and port, such as 8765, "
                                  "127.0.0.1:8765 or 0.0.0.0:8765");
  where.port = *port;
  return where;
}

Result<std::unique_ptr<Server>> open_server(const ViewOptions& options, std::uint64_t start_ns,
                                            std::uint64_t end_ns, std::string& url) {
  const Where where = KAZ_TRY(parse_where(options.where));
  const sim::RobotModel robot =
      KAZ_TRY(sim::load_robot(options.robot_path, {.skip_missing_meshes = true}));
  ServerOptions server;
  server.address = where.address;
  server.port = where.port;
  server.parameters = {{"robot", options.robot_path},
                       {"source", end_ns > 0 ? "recording" : options.source},
                       {"no_pictures", options.no_pictures}};
  server.hands = options.hands;
  server.start_ns = start_ns;
  server.end_ns = end_ns;
  Access& access = server.access;
  access.token = options.token.empty() ? make_token() : options.token;
  access.open = options.open;
  const auto file = [](const char* type, std::string_view text) {
    return ServedFile{type, Bytes(text.begin(), text.end())};
  };
  if (!options.page_folder.empty()) {
    access.page = KAZ_TRY(page_files(options.page_folder));
    access.page.merge(KAZ_TRY(texture_files()));
  }
  access.page.try_emplace("/index.html",
                          file("text/plain; charset=utf-8", options.no_page + kWithoutPage));
  access.robot = KAZ_TRY(robot_files(options.robot_path, robot));
  if (options.hands) access.robot["/hands.json"] = file("application/json", hands_json(robot));
  const std::string token = access.token;
  auto opened = KAZ_TRY(Server::open(std::move(server)));
  const bool v6 = where.address.find(':') != std::string::npos;
  url = "http://" + (v6 ? "[" + where.address + "]" : where.address) + ":" +
        std::to_string(opened->port()) + "/?token=" + token;
  return opened;
}

Result<std::unique_ptr<View>> View::open(ViewOptions options) {
  std::string url;
  if (options.joints_only)
    options.no_pictures = "no pictures: a motor stand has no cameras";
  else if (options.source == "robot")
    options.no_pictures = "no pictures yet; for a robot at a port, use kaz run --camera";
  auto server = KAZ_TRY(open_server(options, 0, 0, url));
  FeedOptions feeds;
  feeds.recorded_robot = options.source == "simulation" && !options.joints_only;
  feeds.hangs = options.joints_only;
  auto feed = KAZ_TRY(Feed::create(*server, options.robot_path, feeds));
  return std::unique_ptr<View>(
      new View(std::move(options), std::move(server), std::move(feed), std::move(url)));
}

View::View(ViewOptions options, std::unique_ptr<Server> server, Feed feed, std::string url)
    : options_(std::move(options)),
      server_(std::move(server)),
      feed_(std::move(feed)),
      url_(std::move(url)),
      pace_(*server_, pace_channel(), options_.pace, options_.stopped) {
  server_->on_hand([this](const std::string& line) { return hear(line); });
  server_->on_message(
      [this](std::string_view topic, std::uint64_t time_ns, std::span<const std::uint8_t> data) {
        feed_.message(topic, time_ns, data);
      });
}

std::optional<std::uint32_t> View::pace_channel() {
  if (!options_.hands || options_.own_time) return std::nullopt;
  return server_->add_channel({0, "/run/pace", "json", "", "", ""}, true);
}

View::~View() {
  server_->on_hand({});
  coder_.finish();
  server_->drain(2);
  server_->on_message({});
}

void View::picture(const vision::StereoPair& pair) {
  coder_.add([this, pair] { feed_.pictures().pictures(pair, !options_.recorded_pictures); });
}

void View::picture(std::uint32_t channel, const vision::FrameInfo& info,
                   std::function<vision::Image()> draw) {
  coder_.add([this, channel, info, draw = std::move(draw)] {
    feed_.pictures().picture(channel, info, draw());
  });
}

void View::channel(std::uint16_t number, const std::string& topic, const std::string& encoding,
                   const std::string& schema_name, const std::string& schema_encoding,
                   const std::string& schema) {
  tapped_[number] = {
      server_->add_channel({0, topic, encoding, schema_name, schema_encoding, schema}), topic,
      Feed::use_of(topic)};
}

void View::message(std::uint16_t channel, std::uint64_t time_ns,
                   std::span<const std::uint8_t> data) {
  wait();
  const Tapped& tapped = tapped_[channel];
  const bool observed = tapped.use == Feed::Use::always ||
                        (tapped.use == Feed::Use::for_viewers && server_->viewers() > 0);
  server_->publish(tapped.channel, time_ns, data, {lasts(tapped.topic, data), observed});
}

void View::stepped(Time time) {
  if (!options_.own_time) pace_.keep(time);
}

std::string hands_json(const sim::RobotModel& robot) {
  using Json = nlohmann::ordered_json;
  Json all{{"faults", Json::array()},
           {"joints", robot.joint_order()},
           {"limits", Json::object()},
           {"links", Json::array()}};
  for (const sim::RobotJoint& joint : std::span(robot.joints).first(robot.motors()))
    all["limits"][joint.name] = {std::max(joint.lower, -std::numbers::pi),
                                 std::min(joint.upper, std::numbers::pi)};
  for (const faults::Kind& kind : faults::kinds())
    all["faults"].push_back({{"name", kind.name},
                             {"of_joint", kind.target == faults::Target::joint},
                             {"parameter", kind.parameter},
                             {"unit", kind.unit},
                             {"low", kind.low},
                             {"high", kind.high},
                             {"initial", kind.initial},
                             {"text", kind.text}});
  for (const sim::RobotLink& link : robot.links) all["links"].push_back(link.rigid.name);
  return all.dump();
}

Result<void> View::hear(const std::string& line) {
  constexpr std::size_t kMostLines = 1000, kLongestAct = 400;
  const std::lock_guard lock(mutex_);
  const bool of_time =
      line == "pause" || line == "go" || line.starts_with("step ") || line.starts_with("pace ");
  if (of_time && options_.own_time)
    return fail(Fault::usage,
                "`" + line + "` is not valid, because this simulator runs in real time");
  if (of_time && pace_.obey(line)) return {};
  const bool request =
      line == "stop" || line == "end" || line.starts_with("target ") || line.starts_with("play ");
  if (request && !options_.requests)
    return fail(Fault::usage, "`" + line.substr(0, line.find(' ')) +
                                  "` is only valid with kaz run pose --view: in other programs, "
                                  "viewers cannot control the joints");
  if (!request && line.size() > kLongestAct)
    return fail(Fault::usage, "the line is too long: a line may have at most " +
                                  std::to_string(kLongestAct) + " bytes");
  if (!request) KAZ_TRY(sim::parse_hand(line, Time::zero()));
  if (lines_.size() + requests_.size() >= kMostLines)
    return fail(Fault::usage,
                "the run is paused, and its queue of requests is full: continue the run first");
  if (request) {
    requests_.push_back(line);
    return {};
  }
  lines_.push_back(line);
  return {};
}

std::vector<std::string> View::take(Time) {
  std::vector<std::string> lines;
  const std::lock_guard lock(mutex_);
  lines.assign(lines_.begin(), lines_.end());
  lines_.clear();
  acts_ += static_cast<int>(lines.size());
  return lines;
}

std::vector<std::string> View::take_requests() {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> lines(requests_.begin(), requests_.end());
  requests_.clear();
  return lines;
}

void View::refused(const std::string& line, const Error& error) {
  --acts_;
  server_->publish_error("`" + line + "`: " + error.message);
}

// Until a viewer has subscribed, and for a moment no other subscription comes: viewers send several.
void View::wait() {
  if (!options_.wait || waited_) return;
  waited_ = true;
  std::size_t before = 0;
  int quiet = 0;
  while (!options_.stopped() && quiet < 10) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const std::size_t now = server_->subscriptions();
    quiet = now > 0 && now == before ? quiet + 1 : 0;
    before = now;
  }
}

}  // namespace kaz::viewer
