// `--view`: publishes a live run to viewers.
// SPDX-License-Identifier: Apache-2.0
//
// Threads. The run's thread calls the functions of RecordingTap and HandSource. message() only puts the
// message into the server's bounded queue. The server's thread derives the channels of Feed and serves
// viewers. Another thread encodes pictures. The server's thread and the encoding thread have a lower priority
// than the run (nice 10).
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "sim/body/description/robot_model.h"
#include "sim/runtime/simulation/hand_player.h"
#include "sim/runtime/simulation/recording_tap.h"
#include "tools/viewer/feed.h"
#include "tools/viewer/picture_coder.h"
#include "tools/viewer/run_pace.h"
#include "tools/viewer/server.h"

namespace kaz::viewer {

struct ViewOptions {
  std::string where;   // ADDRESS:PORT or PORT; empty: 127.0.0.1:8765
  std::string token;   // 32 hexadecimal digits; empty: View makes a new token
  bool open = false;   // true: programs on this machine may view without the token (Access::open)
  bool wait = false;   // true: the run begins after the first subscription
  bool hands = false;  // true: viewers with the token may send manual actions
  // True: viewers with the token may also send requests to the behavior (behavior::Requests).
  bool requests = false;
  bool own_time = false;  // true: the run follows a real clock; pace and pause are not available
  double pace = 0;        // maximum ratio of the run's time to real time; 0: no limit
  std::string robot_path, page_folder;
  // Text for browsers if page_folder contains no page.
  std::string no_page = "There is no page here";
  // True: the recording has pictures, so the view sends no other pictures.
  bool recorded_pictures = false;
  std::string no_pictures = "no pictures yet";  // text on the page until a picture arrives
  // True: the world has no robot, only joints, for example a motor stand. The page shows a robot that hangs
  // in the air; the world's joints move this robot.
  bool joints_only = false;
  std::string source = "simulation";  // "simulation" or "robot"; a parameter that viewers can read
  // All waits of the view end if `stopped` returns true.
  std::function<bool()> stopped = [] { return false; };
};

struct Where {
  std::string address = "127.0.0.1";
  std::uint16_t port = 8765;
};
// Parses ADDRESS:PORT or PORT. Empty text gives the default. Returns Fault::usage for other text.
Result<Where> parse_where(const std::string& text);

// Returns whether a message stays valid until the next message of the same kind: maps, scene, poses, phases.
// Viewers that connect later also need these messages.
bool lasts(std::string_view topic, std::span<const std::uint8_t> data);

// Opens a server with the files of the page, the robot's file and the robot's meshes. `start_ns` and `end_ns`
// are the range of a recording; both are 0 for a live run. Sets `url` to the address of the page, including
// the token.
Result<std::unique_ptr<Server>> open_server(const ViewOptions& options, std::uint64_t start_ns,
                                            std::uint64_t end_ns, std::string& url);

// Returns the choices for manual actions on the page as JSON: faults, joints and links.
std::string hands_json(const sim::RobotModel& robot);

class View final : public sim::RecordingTap, public sim::HandSource {
 public:
  static Result<std::unique_ptr<View>> open(ViewOptions options);
  ~View() override;

  // Returns the address of the page, including the token.
  const std::string& url() const { return url_; }
  Server& server() { return *server_; }
  // Publishes a pair. Any thread may call this function. A separate thread encodes pictures. If the encoding
  // thread falls behind, the oldest pictures are dropped.
  void picture(const vision::StereoPair& pair);
  bool wants_pictures() { return feed_.pictures().wants_pictures(); }
  // The next three functions publish derived pictures, like the functions of PictureFeed with the same names.
  // `draw` runs on the encoding thread.
  std::uint32_t add_pictures(const std::string& topic) {
    return feed_.pictures().add_pictures(topic);
  }
  bool wants_picture(std::uint32_t channel, const vision::FrameInfo& info) {
    return feed_.pictures().wants_picture(channel, info);
  }
  void picture(std::uint32_t channel, const vision::FrameInfo& info,
               std::function<vision::Image()> draw);
  void ball(const vision::FrameInfo& info, const vision::BallObservation& ball) {
    feed_.pictures().ball(info, ball);
  }
  // If ViewOptions::wait is set, waits for the first subscription. The first message() also waits. Call
  // wait() before the run if the run itself cannot wait in message().
  void wait();

  void channel(std::uint16_t number, const std::string& topic, const std::string& encoding,
               const std::string& schema_name, const std::string& schema_encoding,
               const std::string& schema) override;
  void message(std::uint16_t channel, std::uint64_t time_ns,
               std::span<const std::uint8_t> data) override;
  void stepped(Time time) override;
  std::vector<std::string> take(Time start) override;
  void refused(const std::string& line, const Error& error) override;
  // Returns the requests to the behavior that arrived since the last call.
  std::vector<std::string> take_requests();
  // Returns the number of manual actions that took effect.
  int done_by_hand() const { return acts_; }

 private:
  // Processes a viewer's line, on the server's thread. A line is an action of HandAct, a request to the
  // behavior, or a pace setting. Requests to the behavior are `target`, `play`, `stop` and `end` (pose.cpp).
  // Pace settings are `pause`, `go`, `step SECONDS` (runs for this time and then pauses), and `pace TIMES`
  // (0: no limit). The pace does not change the results of the run.
  Result<void> hear(const std::string& line);
  View(ViewOptions options, std::unique_ptr<Server> server, Feed feed, std::string url);
  // Adds the channel on which viewers read the pace; nullopt if viewers cannot control the pace.
  std::optional<std::uint32_t> pace_channel();

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
  RunPace pace_;

  std::mutex mutex_;                  // guards the next two members
  std::deque<std::string> lines_;     // manual actions for the next step
  std::deque<std::string> requests_;  // requests for the behavior
  PictureCoder coder_;                // its tasks use the members above
};

}  // namespace kaz::viewer
