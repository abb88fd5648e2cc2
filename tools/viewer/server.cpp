// HTTP and WebSocket on one port, with Boost.Beast.
// SPDX-License-Identifier: Apache-2.0
#include "tools/viewer/server.h"

#include <pthread.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <future>
#include <random>
#include <utility>

#include <boost/asio/post.hpp>
#include <boost/beast/http.hpp>

#include "shared/base/hex_text.hpp"
#include "tools/viewer/server_impl.h"
#include "tools/viewer/viewer.h"

namespace kaz::viewer {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using tcp = asio::ip::tcp;
using Error = boost::system::error_code;

constexpr std::chrono::seconds kPatience{10};  // for a request's head, and for a reply to be taken
// How often the server looks into the inbox: publishing does not wake it.
constexpr std::chrono::milliseconds kPeriod{5}, kPeriodAlone{20};

std::string_view view_of(beast::string_view text) {
  return {text.data(), text.size()};
}

// The name of this machine, as its own network knows it.
std::vector<std::string> machine_names() {
  char name[256] = "";
  if (gethostname(name, sizeof name - 1) != 0 || name[0] == 0) return {};
  return {name, std::string(name) + ".local"};
}

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
    http::async_read(
        stream_, buffer_, *parser_, [self = shared_from_this()](Error error, std::size_t) {
          if (!error) return self->answer();
          if (error == http::error::end_of_stream) return self->shut();
          // It is no HTTP, or too long.
          if (error.category() == Error(http::error::bad_method).category())
            self->refuse(http::status::bad_request, "the request is not HTTP, or is too long\n");
        });
  }
  void refuse(http::status status, std::string_view sentence) {
    reply(status, "text/plain",
          {reinterpret_cast<const std::uint8_t*>(sentence.data()), sentence.size()});
  }

 private:
  void answer() {
    const auto& request = parser_->get();
    const auto header = [&](http::field name) {
      return request.count(name) == 1 ? view_of(request[name]) : std::string_view();
    };
    const bool upgrade = beast::websocket::is_upgrade(request);
    const Answer answer = answer_to(
        {view_of(request.method_string()), view_of(request.target()), header(http::field::host),
         header(http::field::origin), header(http::field::sec_websocket_protocol), upgrade},
        server_.options.access);
    if (answer.status == 101) {
      stream_.expires_never();
      return std::make_shared<Viewer>(server_, stream_.release_socket(), counted_, answer)
          ->begin(request);
    }
    if (answer.file == nullptr)
      return refuse(static_cast<http::status>(answer.status), answer.sentence);
    reply(http::status::ok, answer.file->type, answer.file->bytes, answer.any_origin);
  }

  // The bytes must outlive the connection.
  void reply(http::status status, std::string_view type, std::span<const std::uint8_t> bytes,
             bool any_origin = false) {
    using Body = http::span_body<const std::uint8_t>;
    const bool known = parser_ && parser_->is_done();
    const bool head = known && parser_->get().method() == http::verb::head;
    auto response = std::make_shared<http::response<Body>>(status, 11);
    response->set(http::field::content_type, beast::string_view(type.data(), type.size()));
    if (any_origin) response->set(http::field::access_control_allow_origin, "*");
    response->set(http::field::cache_control, "no-cache");
    response->set("X-Content-Type-Options", "nosniff");
    response->set("Referrer-Policy", "no-referrer");
    response->set("Content-Security-Policy",
                  "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: "
                  "data:; connect-src 'self' ws: wss:; frame-ancestors 'none'; base-uri 'none'; "
                  "form-action 'none'");
    response->keep_alive(known && status == http::status::ok && parser_->get().keep_alive());
    if (!head) response->body() = Body::value_type(bytes.data(), bytes.size());
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

}  // namespace

std::uint32_t Channels::add(Channel channel, bool derived) {
  const std::lock_guard lock(adding_);
  const std::size_t count = size_.load(std::memory_order_relaxed);
  for (std::size_t i = 0; i < count; ++i) {
    if (all_[i]->channel.topic == channel.topic) return all_[i]->channel.id;
  }
  channel.id = static_cast<std::uint32_t>(count);
  if (count >= kMostChannels) return channel.id;  // no viewer can want it
  all_[count] = std::make_unique<const Offered>(Offered{std::move(channel), derived});
  size_.store(count + 1, std::memory_order_release);
  return static_cast<std::uint32_t>(count);
}

void Server::Impl::accept() {
  acceptor.async_accept([this](Error error, tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    if (!error) {
      const bool full = connections >= options.most_connections;
      const auto visitor = std::make_shared<Visitor>(*this, std::move(socket));
      full ? visitor->refuse(http::status::service_unavailable,
                             "too many viewers are connected: close another viewer and try again\n")
           : visitor->read();
      return accept();
    }
    next_accept.expires_after(std::chrono::milliseconds(100));
    next_accept.async_wait([this](Error ended) {
      if (!ended) accept();
    });
  });
}

void Server::Impl::take_regularly() {
  take();
  next_take.expires_after(viewers.empty() ? kPeriodAlone : kPeriod);
  next_take.async_wait([this](Error ended) {
    if (!ended) take_regularly();
  });
}

void Server::Impl::take() {
  for (SharedMessage& message : inbox.take()) {
    const std::uint64_t number = taken++;
    const std::uint32_t channel = message->channel;
    if (message->observed) {
      const std::lock_guard lock(handlers);
      if (on_message) on_message(channels[channel].channel.topic, message->time_ns, message->data);
    }
    const bool everyone = channel == Message::kEveryone;
    if (message->kept && everyone) newest_for_everyone = message;
    if (message->kept && !everyone) newest[channel] = {message, number};
    if (everyone || wanted[channel] > 0) add_to_log(std::move(message), number);
  }
  for (Viewer* viewer : viewers) viewer->write();
}

void Server::Impl::add_to_log(SharedMessage message, std::uint64_t number) {
  log_bytes += message->size();
  log.push_back({std::move(message), number, Clock::now()});
  while (log_bytes > options.most_logged && log.size() > 1) {
    for (Viewer* viewer : viewers) viewer->miss(log_begin, log.front());
    log_bytes -= log.front().message->size();
    log.pop_front();
    ++log_begin;
  }
}

Server::Server(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Result<std::unique_ptr<Server>> Server::open(ServerOptions options) {
  const std::string where = options.address + ":" + std::to_string(options.port);
  for (std::string& name : machine_names()) options.access.names.push_back(std::move(name));
  auto impl = std::make_unique<Impl>(std::move(options));
  Error error;
  const auto address = asio::ip::make_address(impl->options.address, error);
  if (error)
    return fail(Fault::usage, "--view " + where +
                                  ": the address must be numeric, such as 127.0.0.1:8765 or "
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
  impl->take_regularly();
  Impl* run = impl.get();
  impl->thread = std::thread([run] {
    pthread_setname_np(pthread_self(), "view");
    setpriority(PRIO_PROCESS, 0, kViewNice);  // Linux: of this thread alone
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
  return impl_->channels.add(std::move(channel), derived);
}

bool Server::wanted(std::uint32_t channel) const {
  return channel < kMostChannels && impl_->wanted[channel] > 0;
}

void Server::publish(std::uint32_t channel, std::uint64_t time_ns,
                     std::span<const std::uint8_t> data, Publication how) {
  if (!how.kept && !how.observed && !wanted(channel)) return;
  if (channel >= impl_->channels.size()) return;
  auto message = std::make_shared<const Message>(
      Message{channel, time_ns, how.kept, how.observed, false, Bytes(data.begin(), data.end())});
  if (!impl_->inbox.put(std::move(message))) ++impl_->left_out;
}

void Server::publish_time(std::uint64_t time_ns) {
  impl_->time_ns = time_ns;
}

void Server::publish_playback(const PlaybackState& state) {
  Message message;
  message.kept = true;
  message.data = playback_frame(state);
  impl_->inbox.put(std::make_shared<const Message>(std::move(message)));
}

void Server::publish_error(const std::string& sentence) {
  const std::string text = status(StatusLevel::error, sentence);
  Message message;
  message.text = true;
  message.data.assign(text.begin(), text.end());
  impl_->inbox.put(std::make_shared<const Message>(std::move(message)));
}

void Server::on_playback(std::function<void(const Playback&)> handler) {
  const std::lock_guard lock(impl_->handlers);
  impl_->on_playback = std::move(handler);
}

void Server::on_hand(std::function<Result<void>(const std::string&)> handler) {
  const std::lock_guard lock(impl_->handlers);
  impl_->on_hand = std::move(handler);
}

void Server::on_message(
    std::function<void(std::string_view, std::uint64_t, std::span<const std::uint8_t>)> handler) {
  const std::lock_guard lock(impl_->handlers);
  impl_->on_message = std::move(handler);
}

std::size_t Server::viewers() const {
  return impl_->viewer_count;
}

std::size_t Server::subscriptions() const {
  return impl_->subscription_count;
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
  bool idle = false;
  while (!idle && std::chrono::steady_clock::now() < end) {
    std::promise<bool> answer;
    asio::post(impl_->io, [&] {
      impl_->take();
      answer.set_value(impl_->inbox.empty() &&
                       std::ranges::none_of(impl_->viewers, &Viewer::writing));
    });
    idle = answer.get_future().get();
    if (!idle) std::this_thread::sleep_for(std::chrono::milliseconds(5));
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

}  // namespace kaz::viewer
