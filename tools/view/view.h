// `--view`: a run, live, for viewers.
// SPDX-License-Identifier: Apache-2.0
//
// Threads. The run's thread calls the functions of RecordingTap and HandSource: message() only puts the
// message into the server's bounded queue. The server's thread makes the channels of Feed from it and serves
// viewers. A thread of the view codes pictures. Both have a lower priority than the run (nice 10).
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
  bool open = false;      // programs on this machine may look without it: Access::open
  bool wait = false;      // the run begins with the first viewer
  bool hands = false;     // viewers with the token may do things by hand
  bool requests = false;  // and ask the behaviour for something (behavior::Requests)
  bool own_time = false;  // it goes by a clock: there is no pace, and no pause
  double pace = 0;        // the run's time over real time, at most; 0: as fast as it goes
  std::string robot_path, page_folder;
  std::string no_page = "There is no page here";  // what a browser shows where page_folder has none
  bool recorded_pictures = false;                 // the recording has them: no others are sent
  std::string no_pictures = "no pictures yet";    // what the page shows until one comes
  // The world is no robot's, as a motor stand: its joints turn a robot that hangs in the air.
  bool joints_only = false;
  std::string source = "simulation";  // or "robot": a parameter that viewers may read
  std::function<bool()> stopped = [] { return false; };  // waiting ends
};

// Errors (usage): it is neither.
struct Where {
  std::string address = "127.0.0.1";
  std::uint16_t port = 8765;
};
Result<Where> parse_where(const std::string& text);

// Whether a message holds until the next of its kind, so that whoever comes later wants it: maps, phases.
bool lasts(std::string_view topic, std::span<const std::uint8_t> data);

// Files of the page, and the robot's with its meshes, for the server; `url`: what is printed.
Result<std::unique_ptr<Server>> open_server(const ViewOptions& options, std::uint64_t start_ns,
                                            std::uint64_t end_ns, std::string& url);

// What the page offers to do by hand: faults, joints and links, as JSON.
std::string hands_json(const sim::RobotModel& robot);

class View final : public sim::RecordingTap, public sim::HandSource {
 public:
  static Result<std::unique_ptr<View>> open(ViewOptions options);
  ~View() override;

  // Address of the page, with its token.
  const std::string& url() const { return url_; }
  Server& server() { return *server_; }
  // From any thread. It is coded on a thread of its own; if that is behind, older ones are left out.
  void picture(const vision::StereoPair& pair);
  bool wants_pictures() const { return feed_.wants_pictures(); }
  // Pictures that are made for viewers: Feed. `draw` runs on that thread.
  std::uint32_t add_pictures(const std::string& topic) { return feed_.add_pictures(topic); }
  bool wants_picture(std::uint32_t channel, const vision::FrameInfo& info) {
    return feed_.wants_picture(channel, info);
  }
  void picture(std::uint32_t channel, const vision::FrameInfo& info,
               std::function<vision::Image()> draw);
  void ball(const vision::FrameInfo& info, const vision::BallObservation& ball) {
    feed_.ball(info, ball);
  }
  // Until a viewer has subscribed, if the options say so: a run that cannot wait in its first message.
  void wait();

  void channel(std::uint16_t number, const std::string& topic, const std::string& encoding,
               const std::string& schema_name, const std::string& schema_encoding,
               const std::string& schema) override;
  void message(std::uint16_t channel, std::uint64_t time_ns,
               std::span<const std::uint8_t> data) override;
  void stepped(Time time) override;
  std::vector<std::string> take(Time start) override;
  void refused(const std::string& line, const Error& error) override;
  // What was asked of the behaviour since the last call.
  std::vector<std::string> take_requests();
  // Acts that were begun.
  int done_by_hand() const { return acts_; }

 private:
  // A viewer's line: of HandAct, a request to the behaviour (`target`, `play`, `stop`, `end`: pose.cpp), or
  // of the run's pace, which changes nothing of the run: `pause`, `go`,
  // `step SECONDS` of the run and then pause, `pace TIMES`, 0: as fast as it goes.
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

  std::mutex mutex_;  // of what follows
  std::condition_variable changed_;
  std::deque<std::function<void()>> pictures_;  // to be coded
  std::deque<std::string> lines_;               // that wait for the next step
  std::deque<std::string> requests_;            // that wait for the behaviour
  bool paused_ = false;
  std::optional<double> step_s_;  // until the pause, not begun
  std::optional<Time> pause_at_;  // of the run
  double pace_ = 0, kept_pace_ = 0;
  bool ended_ = false;
  std::thread coder_;
};

}  // namespace kaz::watch
