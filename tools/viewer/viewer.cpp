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

}  // namespace

Viewer::Viewer(Server::Impl& server, tcp::socket socket, std::shared_ptr<Counted> counted,
               const Answer& answer)
    : server_(server),
      socket_(std::move(socket)),
      counted_(std::move(counted)),
      control_(answer.control),
      outbox_(server, answer.subprotocol) {}

void Viewer::begin(const beast::http::request<beast::http::empty_body>& request) {
  auto timeout = websocket::stream_base::timeout::suggested(beast::role_type::server);
  // A browser on a busy machine answers a ping only when it has read all that was sent before it.
  timeout.idle_timeout = std::chrono::seconds(120);
  timeout.keep_alive_pings = true;
  socket_.set_option(timeout);
  socket_.set_option(websocket::stream_base::decorator([this](websocket::response_type& response) {
    response.set(beast::http::field::sec_websocket_protocol, std::string(outbox_.subprotocol()));
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
  outbox_.begin(server_info(options.name, server_.session, outbox_.subprotocol(),
                            std::move(capabilities), options.start_ns, options.end_ns));
  write();
  read();
}

void Viewer::leave() {
  if (!std::exchange(here_, false)) return;
  server_.viewers.erase(this);
  --server_.viewer_count;
  outbox_.unsubscribe_all();
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
  if (!here_ || reading_ || outbox_.answers() > kMostAnswers) return;
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
  const auto [wrong, twice] = outbox_.subscribe(all);
  if (wrong != nullptr) reject(wrong);
  if (twice != nullptr) answer(status(StatusLevel::warning, twice));
}

void Viewer::unsubscribe(const std::vector<std::uint32_t>& ids) {
  if (!outbox_.unsubscribe(ids)) reject("no subscription has this number");
}

void Viewer::fetch(const Request& request) {
  constexpr std::string_view kPackage = "package://";
  const auto& files = server_.options.access.robot;
  const auto at = request.uri.starts_with(kPackage)
                      ? files.find("/" + request.uri.substr(kPackage.size()))
                      : files.end();
  if (at == files.end()) {
    outbox_.add(
        {false, asset_head(request.asset_request, "this server has no such file"), nullptr, {}});
  } else {
    outbox_.add({false, asset_head(request.asset_request, ""), nullptr, at->second.bytes});
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
  if (!control_)
    return reject("to control the player, open the complete address, including the token");
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
  outbox_.add(text_frame(text));
}

void Viewer::reject(const std::string& sentence) {
  ++wrong_requests_;
  answer(status(StatusLevel::error, sentence));
}

void Viewer::write() {
  if (!here_ || sending_) return;
  sending_ = outbox_.next();
  if (!sending_) return;
  socket_.text(sending_->text);
  const std::array<asio::const_buffer, 2> buffers{
      asio::buffer(sending_->head), asio::buffer(sending_->rest.data(), sending_->rest.size())};
  socket_.async_write(buffers, [self = shared_from_this()](Error error, std::size_t) {
    self->sending_.reset();
    if (error) return self->close();
    self->write();
    self->read();
  });
}

}  // namespace kaz::viewer
