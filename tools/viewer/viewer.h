// A WebSocket connection of the server to one viewer.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>

#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "tools/viewer/outbox.h"
#include "tools/viewer/server_impl.h"

namespace kaz::viewer {

// Use this class on the server's thread only. The server sends one frame at a time to each viewer. The next
// frame is chosen only after the previous frame was sent. Therefore only answers to the viewer's own requests
// are queued.
class Viewer : public std::enable_shared_from_this<Viewer> {
 public:
  // `answer`: result of answer_to() with status 101.
  Viewer(Server::Impl& server, boost::asio::ip::tcp::socket socket,
         std::shared_ptr<Counted> counted, const Answer& answer);
  ~Viewer() { leave(); }
  void begin(const boost::beast::http::request<boost::beast::http::empty_body>& request);

  // Sends the next frame, unless a frame is being sent.
  void write();
  bool writing() const { return sending_.has_value(); }
  // Called before the log drops its oldest message. If the viewer has not yet read this message, skips the
  // message.
  void miss(std::uint64_t position, const Server::Impl::Logged& logged) {
    outbox_.miss(position, logged);
  }

 private:
  using Error = boost::system::error_code;

  void greet();
  void leave();
  void close();
  void end();
  void read();
  void obey();
  void subscribe(const std::vector<Subscription>& all);
  void unsubscribe(const std::vector<std::uint32_t>& ids);
  void fetch(const Request& request);
  void send_parameters(const Request& request);
  void playback(const Playback& wanted);
  void hand(const Request& request);
  void answer(const std::string& text);
  void reject(const std::string& sentence);

  Server::Impl& server_;
  boost::beast::websocket::stream<boost::beast::tcp_stream> socket_;
  std::shared_ptr<Counted> counted_;
  const bool control_;
  Outbox outbox_;
  boost::asio::steady_timer greeting_{server_.io};
  boost::beast::flat_buffer buffer_;
  int wrong_requests_ = 0;
  // Numbers of the viewer's channels on kHandTopic, chosen by the viewer.
  std::set<std::uint32_t> own_channels_;

  bool here_ = false, reading_ = false;
  std::optional<Frame> sending_;
};

}  // namespace kaz::viewer
