// A WebSocket connection of the server.
// SPDX-License-Identifier: Apache-2.0
#include "tools/viewer/viewer.h"

#include <algorithm>
#include <utility>

namespace kaz::viewer {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;

constexpr int kMostWrong = 16;  // requests, before the connection is closed
constexpr std::size_t kMostAnswers = 16;
// In the kernel, for each viewer: that of a slow one holds old messages.
constexpr int kSendBuffer = 256 << 10;
constexpr std::chrono::milliseconds kStale{500};

}  // namespace

Viewer::Viewer(Server::Impl& server, tcp::socket socket, std::shared_ptr<Counted> counted,
               const Answer& answer)
    : server_(server),
      socket_(std::move(socket)),
      counted_(std::move(counted)),
      control_(answer.control),
      subprotocol_(answer.subprotocol) {}

void Viewer::begin(const beast::http::request<beast::http::empty_body>& request) {
  auto timeout = websocket::stream_base::timeout::suggested(beast::role_type::server);
  // A browser on a busy machine answers a ping only when it has read all that was sent before it.
  timeout.idle_timeout = std::chrono::seconds(120);
  timeout.keep_alive_pings = true;
  socket_.set_option(timeout);
  socket_.set_option(websocket::stream_base::decorator([this](websocket::response_type& response) {
    response.set(beast::http::field::sec_websocket_protocol, std::string(subprotocol_));
  }));
  socket_.read_message_max(kLongestRequest);
  socket_.auto_fragment(false);
  Error ignored;
  auto& tcp_socket = beast::get_lowest_layer(socket_).socket();
  tcp_socket.set_option(tcp::no_delay(true), ignored);
  tcp_socket.set_option(asio::socket_base::send_buffer_size(kSendBuffer), ignored);
  beast::get_lowest_layer(socket_).expires_never();
  socket_.async_accept(request, [self = shared_from_this()](Error error) {
    if (error) return;
    // Foxglove's mcap-record begins to listen a moment after it has connected.
    self->greeting_.expires_after(std::chrono::milliseconds(20));
    self->greeting_.async_wait([self](Error ended) {
      if (!ended) self->greet();
    });
  });
}

void Viewer::greet() {
  const ServerOptions& options = server_.options;
  std::vector<std::string> capabilities{"assets", "parameters", "parametersSubscribe", "time"};
  if (options.end_ns > 0) capabilities.push_back("playbackControl");
  if (options.hands) capabilities.push_back("clientPublish");
  here_ = true;
  server_.viewers.insert(this);
  ++server_.viewer_count;
  position_ = server_.log_begin + server_.log.size();
  answer(server_info(options.name, server_.session, subprotocol_, std::move(capabilities),
                     options.start_ns, options.end_ns));
  if (const auto& state = server_.newest_for_everyone; state && reads(*state))
    answers_.push_back({state->text, {}, state, state->data});
  write();
  read();
}

void Viewer::leave() {
  if (!std::exchange(here_, false)) return;
  server_.viewers.erase(this);
  --server_.viewer_count;
  for (const auto& [channel, subscribed] : subscriptions_) --server_.wanted[channel];
  server_.subscription_count -= subscriptions_.size();
  subscriptions_.clear();
  new_.clear();
}

void Viewer::close() {
  leave();
  Error ignored;
  beast::get_lowest_layer(socket_).socket().close(ignored);
}

void Viewer::end() {
  leave();
  socket_.async_close(
      websocket::close_reason(websocket::close_code::policy_error, "too many wrong requests"),
      [self = shared_from_this()](Error) {});
}

// A viewer that does not take its answers is asked for no more requests.
void Viewer::read() {
  if (!here_ || reading_ || answers_.size() > kMostAnswers) return;
  reading_ = true;
  socket_.async_read(buffer_, [self = shared_from_this()](Error error, std::size_t) {
    self->reading_ = false;
    if (error) return self->close();
    self->obey();
    self->buffer_.consume(self->buffer_.size());
    if (self->wrong_requests_ > kMostWrong) return self->end();
    self->write();
    self->read();
  });
}

void Viewer::obey() {
  const auto data = buffer_.data();
  const std::string_view text(static_cast<const char*>(data.data()), data.size());
  const auto request =
      socket_.got_text()
          ? parse_text(text)
          : parse_binary({static_cast<const std::uint8_t*>(data.data()), data.size()});
  if (!request) return reject(request.error().message);
  switch (request->kind) {
    case Request::Kind::subscribe:
      return subscribe(request->subscribe);
    case Request::Kind::unsubscribe:
      return unsubscribe(request->unsubscribe);
    case Request::Kind::fetch_asset:
      return fetch(*request);
    case Request::Kind::parameters:
      return send_parameters(*request);
    case Request::Kind::watch_parameters:
      return;
    case Request::Kind::advertise:
    case Request::Kind::unadvertise:
    case Request::Kind::publish:
      return hand(*request);
    case Request::Kind::playback:
      return playback(request->playback);
  }
}

// One answer at most, however many entries there are.
void Viewer::subscribe(const std::vector<Subscription>& all) {
  server_.take();  // what was published before is older than the subscription
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
  if (wrong != nullptr) reject(wrong);
  if (twice != nullptr) answer(status(StatusLevel::warning, twice));
}

void Viewer::unsubscribe(const std::vector<std::uint32_t>& ids) {
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
  if (wrong) reject("no subscription has this number");
}

void Viewer::fetch(const Request& request) {
  constexpr std::string_view kPackage = "package://";
  const auto& files = server_.options.access.robot;
  const auto at = request.uri.starts_with(kPackage)
                      ? files.find("/" + request.uri.substr(kPackage.size()))
                      : files.end();
  if (at == files.end()) {
    answers_.push_back(
        {false, asset_head(request.asset_request, "this server has no such file"), nullptr, {}});
  } else {
    answers_.push_back({false, asset_head(request.asset_request, ""), nullptr, at->second.bytes});
  }
}

void Viewer::send_parameters(const Request& request) {
  std::map<std::string, std::string> values;
  for (const auto& [name, value] : server_.options.parameters) {
    if (request.parameters.empty() || std::ranges::count(request.parameters, name) > 0)
      values[name] = value;
  }
  answer(parameter_values(values, request.parameters_request));
}

void Viewer::playback(const Playback& wanted) {
  if (server_.options.end_ns == 0)
    return reject("this run is live: only a recording can be played");
  if (!control_) return reject("to control the player, open the address with its token");
  const std::lock_guard lock(server_.handlers);
  if (server_.on_playback) server_.on_playback(wanted);
}

void Viewer::hand(const Request& request) {
  if (!server_.options.hands) return reject("this run cannot be controlled by hand");
  if (!control_) return reject("to control the run by hand, open the address with its token");
  if (request.kind == Request::Kind::publish) {
    if (!own_channels_.contains(request.published))
      return reject("advertise the channel before publishing on it");
    const std::lock_guard lock(server_.handlers);
    const Result<void> done = server_.on_hand ? server_.on_hand(request.line) : Result<void>();
    // No wrong request of the protocol: somebody may type it.
    if (!done) answer(status(StatusLevel::error, done.error().message));
    return;
  }
  for (const std::uint32_t id : request.unadvertise) own_channels_.erase(id);
  own_channels_.insert(request.advertise.begin(), request.advertise.end());
  if (own_channels_.size() > kMostChannels) {
    own_channels_.clear();
    reject("too many channels");
  }
}

void Viewer::answer(const std::string& text) {
  answers_.push_back({true, Bytes(text.begin(), text.end()), nullptr, {}});
}

void Viewer::reject(const std::string& sentence) {
  ++wrong_requests_;
  answer(status(StatusLevel::error, sentence));
}

void Viewer::write() {
  if (!here_ || writing_) return;
  auto frame = next();
  if (!frame) return;
  frame_ = std::move(*frame);
  writing_ = true;
  socket_.text(frame_.text);
  const std::array<asio::const_buffer, 2> buffers{
      asio::buffer(frame_.head), asio::buffer(frame_.rest.data(), frame_.rest.size())};
  socket_.async_write(buffers, [self = shared_from_this()](Error error, std::size_t) {
    self->writing_ = false;
    self->frame_ = {};
    if (error) return self->close();
    self->write();
    self->read();
  });
}

// The frame that the viewer is to get next; nothing if it has everything.
std::optional<Viewer::Frame> Viewer::next() {
  if (!answers_.empty()) {
    Frame frame = std::move(answers_.front());
    answers_.pop_front();
    return frame;
  }
  if (const std::size_t all = server_.channels.size(); announced_ < all) {
    std::vector<Channel> channels;
    for (; announced_ < all; ++announced_) channels.push_back(server_.channels[announced_].channel);
    const std::string text = advertisement(channels);
    return Frame{true, Bytes(text.begin(), text.end()), nullptr, {}};
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
std::optional<Viewer::Frame> Viewer::next_kept() {
  while (!new_.empty()) {
    const std::uint32_t channel = *new_.begin();
    new_.erase(new_.begin());
    const Subscribed& subscribed = subscriptions_.at(channel);
    const auto& kept = server_.newest[channel];
    if (kept.message && kept.number < subscribed.from) return message_of(subscribed, kept.message);
  }
  return std::nullopt;
}

std::optional<Viewer::Frame> Viewer::next_logged() {
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

Viewer::Frame Viewer::message_of(const Subscribed& subscribed, const SharedMessage& message) const {
  return {false, message_head(subscribed.id, message->time_ns), message, message->data};
}

// Whether its protocol has this frame for everyone.
bool Viewer::reads(const Message& message) const {
  return message.text || understands(subprotocol_, message.data.front());
}

bool Viewer::wants(const Server::Impl::Logged& logged) const {
  const Message& message = *logged.message;
  if (message.channel == Message::kEveryone) return reads(message);
  const auto at = subscriptions_.find(message.channel);
  return at != subscriptions_.end() && logged.number >= at->second.from;
}

void Viewer::miss(std::uint64_t position, const Server::Impl::Logged& logged) {
  if (position_ > position) return;
  position_ = position + 1;
  if (wants(logged)) ++server_.left_out;
}

}  // namespace kaz::viewer
