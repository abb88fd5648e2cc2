// Subscriptions of one viewer, and the frames that the viewer gets next.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/viewer/server_impl.h"

namespace kaz::viewer {

// A frame to send: `head`, followed by `rest`. `rest` points into memory of `owner` or of the server's
// options.
struct Frame {
  bool text = false;
  Bytes head;
  SharedMessage owner;
  std::span<const std::uint8_t> rest;
};

Frame text_frame(const std::string& text);

// Use this class on the server's thread only.
class Outbox {
 public:
  // `server` and the text of `subprotocol` must outlive this object.
  Outbox(Server::Impl& server, std::string_view subprotocol)
      : server_(server), subprotocol_(subprotocol) {}

  std::string_view subprotocol() const { return subprotocol_; }
  // The viewer first gets `greeting` and the newest state of the player, and no older messages.
  void begin(const std::string& greeting);
  // Adds an answer to a request of the viewer. Answers are sent before all other frames.
  void add(Frame answer) { answers_.push_back(std::move(answer)); }
  std::size_t answers() const { return answers_.size(); }
  // Texts for the viewer; nullptr: none. `wrong`: an entry has no channel, or its number is taken. `twice`:
  // an entry names a channel to which the viewer already subscribes. The other entries are subscribed.
  struct Refused {
    const char *wrong = nullptr, *twice = nullptr;
  };
  Refused subscribe(const std::vector<Subscription>& all);
  // Returns false if no subscription has one of the numbers.
  bool unsubscribe(const std::vector<std::uint32_t>& ids);
  void unsubscribe_all();
  // Returns the next frame to send; nullopt if the viewer has everything.
  std::optional<Frame> next();
  // Skips the message at `position` in the log if the viewer has not read it.
  void miss(std::uint64_t position, const Server::Impl::Logged& logged);

 private:
  struct Subscribed {
    std::uint32_t id = 0;
    std::uint64_t from = 0;  // number of the first log message to send
  };

  std::optional<Frame> next_kept();
  std::optional<Frame> next_logged();
  Frame message_of(const Subscribed& subscribed, const SharedMessage& message) const;
  bool reads(const Message& message) const;
  bool wants(const Server::Impl::Logged& logged) const;

  Server::Impl& server_;
  const std::string_view subprotocol_;
  std::map<std::uint32_t, Subscribed> subscriptions_;  // key: number of the channel
  std::deque<Frame> answers_;                          // answers to the viewer's requests
  std::size_t announced_ = 0;                          // number of advertised channels
  std::set<std::uint32_t> new_;  // channels whose kept message has not been sent yet
  std::uint64_t position_ = 0;   // next position to read in the log
  std::uint64_t sent_time_ns_ = Server::Impl::kNoTime;
};

}  // namespace kaz::viewer
