// `--view`: a run, live, for viewers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "sim/runtime/simulation/recording_tap.h"
#include "tools/view/feed.h"
#include "tools/view/server.h"

namespace kaz::watch {

struct ViewOptions {
  std::string where;  // ADDRESS:PORT or PORT; empty: 127.0.0.1:8765
  bool wait = false;  // the run begins with the first viewer
  double pace = 0;    // the run's time over real time, at most; 0: as fast as it goes
  std::string robot_path, page_folder;
  bool recorded_pictures = false;  // the recording has them: no others are sent
  std::function<bool()> stopped = [] { return false; };  // waiting ends
};

// Errors (usage): it is neither.
struct Where {
  std::string address = "127.0.0.1";
  std::uint16_t port = 8765;
  bool loopback = true;
};
Result<Where> parse_where(const std::string& text);

// Whether a message holds until the next of its kind, so that whoever comes later wants it: maps, phases.
bool lasts(std::string_view topic, std::span<const std::uint8_t> data);

// Files of the page, and the robot's with its meshes, for the server; `url`: what is printed.
Result<std::unique_ptr<Server>> open_server(const ViewOptions& options, std::uint64_t start_ns,
                                            std::uint64_t end_ns, std::string& url);

class View final : public sim::RecordingTap {
 public:
  static Result<std::unique_ptr<View>> open(ViewOptions options);
  ~View() override;

  // Address of the page, with its token.
  const std::string& url() const { return url_; }
  Server& server() { return *server_; }
  void picture(const vision::StereoPair& pair);

  void channel(std::uint16_t number, const std::string& topic, const std::string& encoding,
               const std::string& schema_name, const std::string& schema_encoding,
               const std::string& schema) override;
  void message(std::uint16_t channel, std::uint64_t time_ns,
               std::span<const std::uint8_t> data) override;
  void stepped(Time time, const sim::World& world) override;

 private:
  View(ViewOptions options, std::unique_ptr<Server> server, Feed feed, std::string url);
  void wait_for_viewer();
  void keep_pace(Time time);

  ViewOptions options_;
  std::unique_ptr<Server> server_;
  Feed feed_;
  std::string url_;
  struct Tapped {
    std::uint32_t channel = 0;
    std::string topic;
  };
  std::map<std::uint16_t, Tapped> tapped_;
  bool waited_ = false;
  std::optional<std::pair<std::chrono::steady_clock::time_point, Time>> pace_start_;
};

}  // namespace kaz::watch
