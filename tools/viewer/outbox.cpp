// Chooses the next frame for a viewer: answers, new channels, kept messages, the log, the time.
// SPDX-License-Identifier: Apache-2.0
#include "tools/viewer/outbox.h"

#include <algorithm>
#include <utility>

namespace kaz::viewer {
namespace {

constexpr std::chrono::milliseconds kStale{500};

}  // namespace

Frame text_frame(const std::string& text) {
  return {true, Bytes(text.begin(), text.end()), nullptr, {}};
}

void Outbox::begin(const std::string& greeting) {
  position_ = server_.log_begin + server_.log.size();
  add(text_frame(greeting));
  if (const auto& state = server_.newest_for_everyone; state && reads(*state))
    add({state->text, {}, state, state->data});
}

Outbox::Refused Outbox::subscribe(const std::vector<Subscription>& all) {
  const char *wrong = nullptr, *twice = nullptr;
  for (const Subscription& one : all) {
    const bool taken = std::ranges::any_of(
        subscriptions_, [&](const auto& other) { return other.second.id == one.id; });
    if (one.channel >= server_.channels.size()) {
      wrong = "no channel has this number";
    } else if (taken) {
      wrong = "a subscription with this number already exists";
    } else if (subscriptions_.contains(one.channel)) {
      twice = "this viewer already subscribes to this channel; the second subscription is ignored";
    } else {
      subscriptions_[one.channel] = {one.id, server_.taken};
      ++server_.wanted[one.channel];
      ++server_.subscription_count;
      new_.insert(one.channel);
    }
  }
  return {wrong, twice};
}

bool Outbox::unsubscribe(const std::vector<std::uint32_t>& ids) {
  bool wrong = false;
  for (const std::uint32_t id : ids) {
    const auto at =
        std::ranges::find_if(subscriptions_, [&](const auto& one) { return one.second.id == id; });
    wrong = wrong || at == subscriptions_.end();
    if (at == subscriptions_.end()) continue;
    --server_.wanted[at->first];
    --server_.subscription_count;
    new_.erase(at->first);
    subscriptions_.erase(at);
  }
  return !wrong;
}

void Outbox::unsubscribe_all() {
  for (const auto& [channel, subscribed] : subscriptions_) --server_.wanted[channel];
  server_.subscription_count -= subscriptions_.size();
  subscriptions_.clear();
  new_.clear();
}

std::optional<Frame> Outbox::next() {
  if (!answers_.empty()) {
    Frame frame = std::move(answers_.front());
    answers_.pop_front();
    return frame;
  }
  if (const std::size_t all = server_.channels.size(); announced_ < all) {
    std::vector<Channel> channels;
    for (; announced_ < all; ++announced_) channels.push_back(server_.channels[announced_].channel);
    return text_frame(advertisement(channels));
  }
  if (auto frame = next_kept()) return frame;
  if (auto frame = next_logged()) return frame;
  const std::uint64_t time_ns = server_.time_ns;
  if (time_ns == sent_time_ns_) return std::nullopt;
  sent_time_ns_ = time_ns;
  return Frame{false, time_frame(time_ns), nullptr, {}};
}

// The newest kept message of a channel that it has just subscribed to. If that was published after the
// subscription, it comes from the log.
std::optional<Frame> Outbox::next_kept() {
  while (!new_.empty()) {
    const std::uint32_t channel = *new_.begin();
    new_.erase(new_.begin());
    const Subscribed& subscribed = subscriptions_.at(channel);
    const auto& kept = server_.newest[channel];
    if (kept.message && kept.number < subscribed.from) return message_of(subscribed, kept.message);
  }
  return std::nullopt;
}

std::optional<Frame> Outbox::next_logged() {
  const std::uint64_t end = server_.log_begin + server_.log.size();
  while (position_ < end) {
    const auto& logged = server_.log[position_++ - server_.log_begin];
    if (!wants(logged)) continue;
    const Message& message = *logged.message;
    if (message.channel == Message::kEveryone)
      return Frame{message.text, {}, logged.message, message.data};
    if (server_.channels[message.channel].derived &&
        Server::Impl::Clock::now() - logged.at > kStale) {
      ++server_.left_out;
      continue;
    }
    return message_of(subscriptions_.at(message.channel), logged.message);
  }
  return std::nullopt;
}

Frame Outbox::message_of(const Subscribed& subscribed, const SharedMessage& message) const {
  return {false, message_head(subscribed.id, message->time_ns), message, message->data};
}

// Whether its protocol has this frame for everyone.
bool Outbox::reads(const Message& message) const {
  return message.text || understands(subprotocol_, message.data.front());
}

bool Outbox::wants(const Server::Impl::Logged& logged) const {
  const Message& message = *logged.message;
  if (message.channel == Message::kEveryone) return reads(message);
  const auto at = subscriptions_.find(message.channel);
  return at != subscriptions_.end() && logged.number >= at->second.from;
}

void Outbox::miss(std::uint64_t position, const Server::Impl::Logged& logged) {
  if (position_ > position) return;
  position_ = position + 1;
  if (wants(logged)) ++server_.left_out;
}

}  // namespace kaz::viewer
