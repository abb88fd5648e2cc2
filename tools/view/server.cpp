// HTTP and WebSocket on one port, with Boost.Beast.
// SPDX-License-Identifier: Apache-2.0
#include "tools/view/server.h"

#include <pthread.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <deque>
#include <mutex>
#include <optional>
#include <random>
#include <set>
#include <thread>
#include <utility>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "shared/base/hex_text.hpp"

namespace kaz::watch {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using Error = boost::system::error_code;
using Frame = std::shared_ptr<const Bytes>;

constexpr std::chrono::seconds kPatience{10};  // for a request's head, and for a reply to be taken
constexpr int kMostWrong = 16;                 // requests of a viewer, before it is closed
constexpr std::size_t kMostSubscriptions = 512;
constexpr std::size_t kMostChannels = 256;
constexpr std::size_t kMostAnswers = 16;  // that wait for a viewer beyond its bound

std::string_view view_of(beast::string_view text) {
  return {text.data(), text.size()};
}

std::string_view query_of(std::string_view target) {
  const auto mark = target.find('?');
  return mark == std::string_view::npos ? std::string_view() : target.substr(mark + 1);
}

// Takes as long for every wrong one.
bool equal_secret(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned differ = 0;
  for (std::size_t i = 0; i < a.size(); ++i) differ |= static_cast<unsigned>(a[i] ^ b[i]);
  return differ == 0;
}

bool has_token(std::string_view target, const std::string& token) {
  if (token.empty()) return false;
  for (std::string_view rest = query_of(target); !rest.empty();) {
    const auto end = rest.find('&');
    const std::string_view word = rest.substr(0, end);
    rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
    if (word.starts_with("token=") && equal_secret(word.substr(6), token)) return true;
  }
  return false;
}

}  // namespace

class Viewer;

struct Server::Impl {
  explicit Impl(ServerOptions given) : options(std::move(given)), session(make_token()) {}

  struct Offered {
    Channel channel;
    bool derived = false;
    std::optional<std::pair<std::uint64_t, Bytes>> newest;  // of a kept one
  };

  void accept();
  std::vector<std::string> capabilities() const {
    std::vector<std::string> all{"assets", "parameters", "parametersSubscribe", "time"};
    if (options.end_ns > 0) all.push_back("playbackControl");
    if (options.hands) all.push_back("clientPublish");
    return all;
  }

  const ServerOptions options;
  const std::string session;
  std::size_t connections = 0;  // on the server's thread
  std::atomic<std::uint64_t> left_out{0};
  std::array<std::atomic<int>, kMostChannels> wanted{};  // subscriptions by channel
  mutable std::mutex mutex;       // of all up to `io`, and of viewers' queues and subscriptions
  std::optional<Bytes> playback;  // the newest state
  std::function<void(const Playback&)> heard;
  std::function<Result<void>(const std::string&)> hand;
  std::deque<Offered> channels;
  std::set<Viewer*> viewers;
  // Its handlers hold viewers, which refer to what is above.
  asio::io_context io{1};
  tcp::acceptor acceptor{io};
  asio::steady_timer again{io};  // when no file descriptor was left
  std::thread thread;
};

// Counts a connection while it lives.
class Counted {
 public:
  explicit Counted(std::size_t& count) : count_(count) { ++count_; }
  ~Counted() { --count_; }
  Counted(const Counted&) = delete;
  Counted& operator=(const Counted&) = delete;

 private:
  std::size_t& count_;
};

// A WebSocket connection.
class Viewer : public std::enable_shared_from_this<Viewer> {
 public:
  Viewer(Server::Impl& server, tcp::socket socket, std::shared_ptr<Counted> counted, bool control)
      : server_(server),
        socket_(std::move(socket)),
        counted_(std::move(counted)),
        control_(control) {}
  ~Viewer() { leave(); }

  template <class Request>
  void begin(const Request& request, std::string_view subprotocol) {
    auto timeout = websocket::stream_base::timeout::suggested(beast::role_type::server);
    // A browser on a busy machine answers a ping only when it has read all that was sent before it.
    timeout.idle_timeout = std::chrono::seconds(120);
    timeout.keep_alive_pings = true;
    socket_.set_option(timeout);
    socket_.set_option(websocket::stream_base::decorator(
        [name = std::string(subprotocol)](websocket::response_type& response) {
          response.set(http::field::sec_websocket_protocol, name);
        }));
    socket_.read_message_max(kLongestRequest);
    socket_.auto_fragment(false);
    socket_.binary(true);
    Error ignored;
    beast::get_lowest_layer(socket_).socket().set_option(tcp::no_delay(true), ignored);
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

  // Below the server's mutex.
  void put_text(std::string text) {
    put(std::make_shared<const Bytes>(text.begin(), text.end()), true);
  }
  void put(Frame frame, bool text) {
    waiting_bytes_ += frame->size();
    waiting_.push_back({std::move(frame), text});
    if (writing_) return;
    writing_ = true;
    asio::post(server_.io, [self = weak_from_this()] {
      if (const auto viewer = self.lock()) viewer->write();
    });
  }
  void give(Server::Impl::Offered& offered, std::uint64_t time_ns,
            std::span<const std::uint8_t> data) {
    for (const Subscription& one : subscriptions_) {
      if (one.channel != offered.channel.id) continue;
      const std::size_t most =
          offered.derived ? server_.options.most_waiting_derived : server_.options.most_waiting;
      if (waiting_bytes_ + data.size() > most && !waiting_.empty()) {
        ++server_.left_out;
        continue;
      }
      put(std::make_shared<const Bytes>(message_frame(one.id, time_ns, data)), false);
    }
  }
  bool idle() const { return waiting_.empty(); }
  std::size_t subscriptions() const { return subscriptions_.size(); }
  void close() {
    Error ignored;
    beast::get_lowest_layer(socket_).socket().close(ignored);
  }

 private:
  struct Waiting {
    Frame frame;
    bool text;
  };

  void greet() {
    {
      const std::lock_guard lock(server_.mutex);
      server_.viewers.insert(this);
      here_ = true;
      put_text(server_info(server_.options.name, server_.session, server_.capabilities(),
                           server_.options.start_ns, server_.options.end_ns));
      std::vector<Channel> channels;
      for (const auto& offered : server_.channels) channels.push_back(offered.channel);
      put_text(advertisement(channels));
      if (server_.playback) put(std::make_shared<const Bytes>(*server_.playback), false);
    }
    read();
  }

  void leave() {
    const std::lock_guard lock(server_.mutex);
    if (!here_) return;
    here_ = false;
    server_.viewers.erase(this);
    for (const Subscription& one : subscriptions_) --server_.wanted[one.channel];
    subscriptions_.clear();
  }

  void read() {
    socket_.async_read(buffer_, [self = shared_from_this()](Error error, std::size_t) {
      if (error) return self->leave();
      self->take();
      if (self->wrong_ > kMostWrong || self->greedy()) return self->end();
      self->buffer_.clear();
      self->read();
    });
  }

  // Asks on and on, and takes no answer.
  bool greedy() const {
    const std::lock_guard lock(server_.mutex);
    return waiting_.size() > kMostAnswers && waiting_bytes_ > 2 * server_.options.most_waiting;
  }

  void take() {
    const auto data = buffer_.data();
    const std::string_view text(static_cast<const char*>(data.data()), data.size());
    const auto request =
        socket_.got_text()
            ? parse_text(text)
            : parse_binary({static_cast<const std::uint8_t*>(data.data()), data.size()});
    if (!request) return refuse(request.error().message);
    switch (request->kind) {
      case Request::Kind::subscribe:
        for (const Subscription& one : request->subscribe) subscribe(one);
        break;
      case Request::Kind::unsubscribe:
        for (const std::uint32_t id : request->unsubscribe) unsubscribe(id);
        break;
      case Request::Kind::fetch_asset:
        fetch(*request);
        break;
      case Request::Kind::parameters:
        parameters(*request);
        break;
      case Request::Kind::watch_parameters:
        break;
      case Request::Kind::advertise:
      case Request::Kind::unadvertise:
      case Request::Kind::publish:
        hand(*request);
        break;
      case Request::Kind::playback:
        if (server_.options.end_ns == 0) {
          refuse("this run is live: there is nothing to play");
        } else if (!control_) {
          refuse("only who opens the address with its token may control the player");
        } else {
          const std::lock_guard lock(server_.mutex);
          if (server_.heard) server_.heard(request->playback);
        }
        break;
    }
  }

  void hand(const Request& request) {
    if (!server_.options.hands) return refuse("nothing can be done by hand here");
    if (!control_) return refuse("only who opens the address with its token may do things by hand");
    if (request.kind == Request::Kind::publish) {
      if (!own_channels_.contains(request.published))
        return refuse("publish on a channel that was advertised");
      const std::lock_guard lock(server_.mutex);
      const Result<void> done = server_.hand ? server_.hand(request.line) : Result<void>();
      // No wrong request of the protocol: somebody may type it.
      if (!done) put_text(status_error(done.error().message));
      return;
    }
    for (const std::uint32_t id : request.unadvertise) own_channels_.erase(id);
    own_channels_.insert(request.advertise.begin(), request.advertise.end());
    if (own_channels_.size() > kMostSubscriptions) {
      own_channels_.clear();
      refuse("too many channels");
    }
  }

  void subscribe(const Subscription& wanted) {
    const std::lock_guard lock(server_.mutex);
    const bool taken = std::any_of(subscriptions_.begin(), subscriptions_.end(),
                                   [&](const Subscription& one) { return one.id == wanted.id; });
    if (wanted.channel >= server_.channels.size() || taken ||
        subscriptions_.size() >= kMostSubscriptions) {
      ++wrong_;
      return put_text(status_error(taken ? "a subscription of that number is there already"
                                   : wanted.channel >= server_.channels.size()
                                       ? "there is no channel of that number"
                                       : "too many subscriptions"));
    }
    subscriptions_.push_back(wanted);
    auto& offered = server_.channels[wanted.channel];
    ++server_.wanted[wanted.channel];
    if (offered.newest)
      put(std::make_shared<const Bytes>(
              message_frame(wanted.id, offered.newest->first, offered.newest->second)),
          false);
  }

  void unsubscribe(std::uint32_t id) {
    const std::lock_guard lock(server_.mutex);
    const auto at = std::find_if(subscriptions_.begin(), subscriptions_.end(),
                                 [&](const Subscription& one) { return one.id == id; });
    if (at == subscriptions_.end()) {
      ++wrong_;
      return put_text(status_error("there is no subscription of that number"));
    }
    --server_.wanted[at->channel];
    subscriptions_.erase(at);
  }

  void fetch(const Request& request) {
    constexpr std::string_view kPackage = "package://";
    Result<Bytes> asset = fail(Fault::usage, "there is no such file here");
    if (std::string_view(request.uri).starts_with(kPackage)) {
      const auto at = server_.options.robot.find("/" + request.uri.substr(kPackage.size()));
      if (at != server_.options.robot.end()) asset = at->second.bytes;
    }
    const std::lock_guard lock(server_.mutex);
    // Who does not take what it has asked for gets no more of it.
    if (waiting_bytes_ > server_.options.most_waiting)
      asset = fail(Fault::usage, "too many requests are under way");
    put(std::make_shared<const Bytes>(asset_frame(request.asset_request, asset)), false);
  }

  void parameters(const Request& request) {
    std::map<std::string, std::string> values;
    for (const auto& [name, value] : server_.options.parameters) {
      if (request.parameters.empty() || std::ranges::count(request.parameters, name) > 0)
        values[name] = value;
    }
    const std::lock_guard lock(server_.mutex);
    put_text(parameter_values(values, request.parameters_request));
  }

  void refuse(const std::string& sentence) {
    ++wrong_;
    const std::lock_guard lock(server_.mutex);
    put_text(status_error(sentence));
  }

  void write() {
    Waiting next;
    {
      const std::lock_guard lock(server_.mutex);
      if (waiting_.empty()) {
        writing_ = false;
        return;
      }
      next = waiting_.front();
    }
    socket_.text(next.text);
    const auto buffer = asio::buffer(*next.frame);
    socket_.async_write(buffer,
                        [self = shared_from_this(), frame = next.frame](Error error, std::size_t) {
                          {
                            const std::lock_guard lock(self->server_.mutex);
                            self->waiting_bytes_ -= frame->size();
                            self->waiting_.pop_front();
                          }
                          if (error) {
                            self->leave();
                            return self->close();
                          }
                          self->write();
                        });
  }

  void end() {
    leave();
    socket_.async_close(
        websocket::close_reason(websocket::close_code::policy_error, "too many wrong requests"),
        [self = shared_from_this()](Error) {});
  }

  Server::Impl& server_;
  websocket::stream<beast::tcp_stream> socket_;
  std::shared_ptr<Counted> counted_;
  const bool control_;
  asio::steady_timer greeting_{server_.io};
  beast::flat_buffer buffer_;
  int wrong_ = 0;
  std::set<std::uint32_t> own_channels_;  // kHandTopic, as the viewer numbers them
  // Below the server's mutex.
  bool here_ = false, writing_ = false;
  std::deque<Waiting> waiting_;
  std::size_t waiting_bytes_ = 0;
  std::vector<Subscription> subscriptions_;
};

// A connection until it is a viewer.
class Visitor : public std::enable_shared_from_this<Visitor> {
 public:
  Visitor(Server::Impl& server, tcp::socket socket)
      : server_(server),
        stream_(std::move(socket)),
        counted_(std::make_shared<Counted>(server.connections)) {}

  void read() {
    parser_.emplace();
    parser_->header_limit(8 << 10);
    parser_->body_limit(0);
    stream_.expires_after(kPatience);
    http::async_read(stream_, buffer_, *parser_,
                     [self = shared_from_this()](Error error, std::size_t) {
                       if (!error) return self->answer();
                       if (error == http::error::end_of_stream) return self->shut();
                       // Of what is no HTTP, or too long.
                       if (error.category() == Error(http::error::bad_method).category())
                         self->reply(http::status::bad_request, "text/plain", "no such request\n");
                     });
  }
  void refuse() { reply(http::status::service_unavailable, "text/plain", "too many viewers\n"); }

 private:
  void answer() {
    const auto& request = parser_->get();
    const std::string_view target = view_of(request.target());
    const bool knows = has_token(target, server_.options.token);
    if (websocket::is_upgrade(request)) {
      const std::string_view chosen =
          chosen_subprotocol(view_of(request[http::field::sec_websocket_protocol]));
      if (chosen.empty())
        return reply(http::status::bad_request, "text/plain",
                     "this server speaks foxglove.sdk.v1 and foxglove.websocket.v1\n");
      if (!knows && (server_.options.token_to_look || target.find("token=") != target.npos))
        return reply(http::status::forbidden, "text/plain",
                     "wrong token: open the address that kaz has printed\n");
      stream_.expires_never();
      return std::make_shared<Viewer>(server_, stream_.release_socket(), counted_, knows)
          ->begin(request, chosen);
    }
    if (request.method() != http::verb::get && request.method() != http::verb::head)
      return reply(http::status::method_not_allowed, "text/plain", "GET and HEAD only\n");
    const std::string path(target.substr(0, target.find('?')));
    const auto& page = server_.options.page;
    const auto& robot = server_.options.robot;
    if (const auto at = page.find(path == "/" ? "/index.html" : path); at != page.end())
      return reply(http::status::ok, at->second.type, at->second.bytes);
    if (const auto at = robot.find(path); at != robot.end()) {
      if (server_.options.token_to_look && !knows)
        return reply(http::status::forbidden, "text/plain",
                     "wrong token: open the address that kaz has printed\n");
      return reply(http::status::ok, at->second.type, at->second.bytes);
    }
    reply(http::status::not_found, "text/plain", "there is no such page\n");
  }

  void reply(http::status status, const std::string& type, std::string_view text) {
    reply(status, type, Bytes(text.begin(), text.end()));
  }
  void reply(http::status status, const std::string& type, const Bytes& bytes) {
    const bool known = parser_ && parser_->is_done();
    const bool head = known && parser_->get().method() == http::verb::head;
    auto response = std::make_shared<http::response<http::vector_body<std::uint8_t>>>(status, 11);
    response->set(http::field::content_type, type);
    response->set(http::field::access_control_allow_origin, "*");
    response->set(http::field::cache_control, "no-cache");
    response->set("X-Content-Type-Options", "nosniff");
    response->set("Referrer-Policy", "no-referrer");
    response->set("Content-Security-Policy",
                  "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: "
                  "data:; connect-src 'self' ws: wss:; frame-ancestors 'none'; base-uri 'none'; "
                  "form-action 'none'");
    response->keep_alive(known && status == http::status::ok && parser_->get().keep_alive());
    if (!head) response->body() = bytes;
    response->content_length(bytes.size());
    stream_.expires_after(kPatience);
    http::async_write(stream_, *response,
                      [self = shared_from_this(), response](Error error, std::size_t) {
                        if (error) return;
                        if (!response->keep_alive()) return self->shut();
                        self->read();
                      });
  }
  void shut() {
    Error ignored;
    stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
  }

  Server::Impl& server_;
  beast::tcp_stream stream_;
  std::shared_ptr<Counted> counted_;
  beast::flat_buffer buffer_{16 << 10};
  std::optional<http::request_parser<http::empty_body>> parser_;
};

void Server::Impl::accept() {
  acceptor.async_accept([this](Error error, tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    if (!error) {
      const bool full = connections >= options.most_connections;
      const auto visitor = std::make_shared<Visitor>(*this, std::move(socket));
      full ? visitor->refuse() : visitor->read();
      return accept();
    }
    again.expires_after(std::chrono::milliseconds(100));
    again.async_wait([this](Error ended) {
      if (!ended) accept();
    });
  });
}

Server::Server(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Result<std::unique_ptr<Server>> Server::open(ServerOptions options) {
  const std::string where = options.address + ":" + std::to_string(options.port);
  auto impl = std::make_unique<Impl>(std::move(options));
  Error error;
  const auto address = asio::ip::make_address(impl->options.address, error);
  if (error)
    return fail(Fault::usage, "--view " + where +
                                  ": the address must be numbers, as 127.0.0.1:8765 or "
                                  "0.0.0.0:8765");
  const tcp::endpoint endpoint(address, impl->options.port);
  impl->acceptor.open(endpoint.protocol(), error);
  if (!error) impl->acceptor.set_option(asio::socket_base::reuse_address(true), error);
  if (!error) impl->acceptor.bind(endpoint, error);
  if (!error) impl->acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (error)
    return fail(Fault::environment, "cannot serve the view at " + where + ": " + error.message() +
                                        "; give another address or port: --view 127.0.0.1:8766");
  impl->accept();
  Impl* run = impl.get();
  impl->thread = std::thread([run] {
    pthread_setname_np(pthread_self(), "view");
    run->io.run();
  });
  return std::unique_ptr<Server>(new Server(std::move(impl)));
}

Server::~Server() {
  impl_->io.stop();
  impl_->thread.join();
}

std::uint16_t Server::port() const {
  Error ignored;
  return impl_->acceptor.local_endpoint(ignored).port();
}

std::uint32_t Server::add_channel(Channel channel, bool derived) {
  const std::lock_guard lock(impl_->mutex);
  for (const auto& offered : impl_->channels) {
    if (offered.channel.topic == channel.topic) return offered.channel.id;
  }
  channel.id = static_cast<std::uint32_t>(impl_->channels.size());
  if (channel.id >= kMostChannels) return channel.id;  // nobody can want it
  auto& offered = impl_->channels.emplace_back();
  offered.channel = std::move(channel);
  offered.derived = derived;
  const std::string text = advertisement({&offered.channel, 1});
  for (Viewer* viewer : impl_->viewers) viewer->put_text(text);
  return offered.channel.id;
}

bool Server::wanted(std::uint32_t channel) const {
  return channel < kMostChannels && impl_->wanted[channel] > 0;
}

void Server::publish(std::uint32_t channel, std::uint64_t time_ns,
                     std::span<const std::uint8_t> data, bool kept) {
  if (!kept && !wanted(channel)) return;
  const std::lock_guard lock(impl_->mutex);
  if (channel >= impl_->channels.size()) return;
  auto& offered = impl_->channels[channel];
  if (kept) offered.newest.emplace(time_ns, Bytes(data.begin(), data.end()));
  for (Viewer* viewer : impl_->viewers) viewer->give(offered, time_ns, data);
}

void Server::publish_time(std::uint64_t time_ns) {
  const std::lock_guard lock(impl_->mutex);
  if (impl_->viewers.empty()) return;
  const auto frame = std::make_shared<const Bytes>(time_frame(time_ns));
  for (Viewer* viewer : impl_->viewers) {
    if (viewer->idle()) viewer->put(frame, false);
  }
}

void Server::publish_playback(const PlaybackState& state) {
  const std::lock_guard lock(impl_->mutex);
  impl_->playback = playback_frame(state);
  const auto frame = std::make_shared<const Bytes>(*impl_->playback);
  for (Viewer* viewer : impl_->viewers) viewer->put(frame, false);
}

void Server::on_playback(std::function<void(const Playback&)> heard) {
  const std::lock_guard lock(impl_->mutex);
  impl_->heard = std::move(heard);
}

void Server::on_hand(std::function<Result<void>(const std::string&)> heard) {
  const std::lock_guard lock(impl_->mutex);
  impl_->hand = std::move(heard);
}

void Server::publish_error(const std::string& sentence) {
  const std::lock_guard lock(impl_->mutex);
  for (Viewer* viewer : impl_->viewers) viewer->put_text(status_error(sentence));
}

std::size_t Server::viewers() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->viewers.size();
}

std::size_t Server::subscriptions() const {
  const std::lock_guard lock(impl_->mutex);
  std::size_t count = 0;
  for (const Viewer* viewer : impl_->viewers) count += viewer->subscriptions();
  return count;
}

std::uint64_t Server::left_out() const {
  return impl_->left_out;
}

std::uint64_t Server::cpu_ns() const {
  clockid_t clock{};
  timespec time{};
  if (pthread_getcpuclockid(impl_->thread.native_handle(), &clock) != 0 ||
      clock_gettime(clock, &time) != 0)
    return 0;
  return static_cast<std::uint64_t>(time.tv_sec) * 1'000'000'000 +
         static_cast<std::uint64_t>(time.tv_nsec);
}

void Server::drain(double seconds) const {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (std::chrono::steady_clock::now() < end) {
    {
      const std::lock_guard lock(impl_->mutex);
      bool idle = true;
      for (const Viewer* viewer : impl_->viewers) idle = idle && viewer->idle();
      if (idle) return;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

std::string make_token() {
  std::random_device random;
  Bytes bytes;
  for (int i = 0; i < 4; ++i) {
    const std::uint32_t word = random();
    for (int k = 0; k < 4; ++k) bytes.push_back(static_cast<std::uint8_t>(word >> (8 * k)));
  }
  return hex_text(bytes);
}

}  // namespace kaz::watch
