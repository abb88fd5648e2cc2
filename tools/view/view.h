// `--view`: publishes a live run to viewers.
// SPDX-License-Identifier: Apache-2.0
//
// Threads. The run's thread calls the functions of RecordingTap and HandSource; message() only puts the
// message into the server's bounded queue. The server's thread derives the channels of Feed and serves
// viewers. A thread of the view encodes pictures. Both have a lower priority than the run (nice 10).
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "sim/body/description/robot_model.h"
#include "sim/runtime/simulation/hand_player.h"
#include "sim/runtime/simulation/recording_tap.h"
#include "tools/view/feed.h"
#include "tools/view/server.h"

namespace kaz::watch {

struct ViewOptions {
  std::string where;      // ADDRESS:PORT or PORT; empty: 127.0.0.1:8765
  std::string token;      // 32 hexadecimal digits; empty: a new one
  bool open = false;      // programs on this machine may view without it: Access::open
  bool wait = false;      // the run begins after the first subscription
  bool hands = false;     // viewers with the token may act by hand
  bool requests = false;  // they may also send requests to the behavior (behavior::Requests)
  bool own_time = false;  // the run follows a clock: without pace and pause
  double pace = 0;        // maximum of the run's time over real time; 0: no limit
  std::string robot_path, page_folder;
  std::string no_page = "There is no page here";  // shown in a browser if page_folder has no page
  bool recorded_pictures = false;                 // the recording has pictures; the view sends none
  std::string no_pictures = "no pictures yet";    // shown on the page until a picture arrives
  // The world has no robot, such as a motor stand. Its joints move a robot that hangs in the air.
  bool joints_only = false;
  std::string source = "simulation";                     // or "robot"; a parameter for viewers
  std::function<bool()> stopped = [] { return false; };  // returns true to end all waits
};

struct Where {
  std::string address = "127.0.0.1";
  std::uint16_t port = 8765;
};
// Parses ADDRESS:PORT or PORT; empty: the default. Returns Fault::usage for other text.
Result<Where> parse_where(const std::string& text);

// Returns whether a message is valid until the next of its kind, so that later viewers need it: maps, scene,
// poses, phases.
bool lasts(std::string_view topic, std::span<const std::uint8_t> data);

// Opens a server with the files of the page, and with the robot's file and meshes. `start_ns`, `end_ns`:
// range of a recording, 0 for a live run. Sets `url` to the page's address with its token.
Result<std::unique_ptr<Server>> open_server(const ViewOptions& options, std::uint64_t start_ns,
                                            std::uint64_t end_ns, std::string& url);

// Returns the actions by hand that the page offers: faults, joints and links, as JSON.
std::string hands_json(const sim::RobotModel& robot);

class View final : public sim::RecordingTap, public sim::HandSource {
 public:
  static Result<std::unique_ptr<View>> open(ViewOptions options);
  ~View() override;

  // Returns the page's address, with its token.
  const std::string& url() const { return url_; }
  Server& server() { return *server_; }
  // Publishes a pair. Call it on any thread. A separate thread encodes pictures; if it falls behind, the
  // oldest are dropped.
  void picture(const vision::StereoPair& pair);
  bool wants_pictures() const { return feed_.wants_pictures(); }
  // Derived pictures, as in Feed. `draw` runs on the thread that encodes.
  std::uint32_t add_pictures(const std::string& topic) { return feed_.add_pictures(topic); }
  bool wants_picture(std::uint32_t channel, const vision::FrameInfo& info) {
    return feed_.wants_picture(channel, info);
  }
  void picture(std::uint32_t channel, const vision::FrameInfo& info,
               std::function<vision::Image()> draw);
  void ball(const vision::FrameInfo& info, const vision::BallObservation& ball) {
    feed_.ball(info, ball);
  }
  // Waits for the first subscription if ViewOptions::wait is set. The first message() does so, too. Call it
  // before a run that cannot wait then.
  void wait();

  void channel(std::uint16_t number, const std::string& topic, const std::string& encoding,
               const std::string& schema_name, const std::string& schema_encoding,
               const std::string& schema) override;
  void message(std::uint16_t channel, std::uint64_t time_ns,
               std::span<const std::uint8_t> data) override;
  void stepped(Time time) override;
  std::vector<std::string> take(Time start) override;
  void refused(const std::string& line, const Error& error) override;
  // Returns the requests to the behavior since the last call.
  std::vector<std::string> take_requests();
  // Returns the number of actions by hand that took effect.
  int done_by_hand() const { return acts_; }

 private:
  // Processes a viewer's line, on the server's thread. It is an action of HandAct, or a request to the
  // behavior (`target`, `play`, `stop`, `end`: pose.cpp). Others set the pace, which does not change the run:
  // `pause`, `go`, `step SECONDS` of the run and then pause, and `pace TIMES` (0: no limit).
  Result<void> hear(const std::string& line);
  View(ViewOptions options, std::unique_ptr<Server> server, Feed feed, std::string url);
  void keep_pace(Time time);
  void state_pace(Time time, bool paused, double pace);
  void code(std::function<void()> picture);
  void code_pictures();

  ViewOptions options_;
  std::unique_ptr<Server> server_;
  Feed feed_;
  std::string url_;
  struct Tapped {
    std::uint32_t channel = 0;
    std::string topic;
    Feed::Use use = Feed::Use::never;
  };
  std::map<std::uint16_t, Tapped> tapped_;
  bool waited_ = false;
  int acts_ = 0;
  std::optional<std::pair<std::chrono::steady_clock::time_point, Time>> pace_start_;
  std::optional<std::uint32_t> pace_channel_;
  std::optional<std::pair<bool, double>> stated_pace_;  // paused, pace

  std::mutex mutex_;  // guards the members below
  std::condition_variable changed_;
  std::deque<std::function<void()>> pictures_;  // to be encoded
  std::deque<std::string> lines_;               // actions for the next step
  std::deque<std::string> requests_;            // requests for the behavior
  bool paused_ = false;
  std::optional<double> step_s_;  // requested step that has not begun
  std::optional<Time> pause_at_;  // in the run's time
  double pace_ = 0, kept_pace_ = 0;
  bool ended_ = false;
  std::thread coder_;
};

}  // namespace kaz::watch
