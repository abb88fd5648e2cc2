// Accepts a client, and obeys what it says of rate and modem lines.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/port_server.h"

#include <poll.h>
#include <sys/epoll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "host/link/tcp_socket.h"
#include "host/link/wall_clock.h"

namespace kaz::host {

namespace {

using namespace telnet;

constexpr int kMaxBaud = 4'000'000;
constexpr int kMaxAccepted = 8;  // at once, so that a flood of clients does not hold up the board
constexpr Time kAcceptPause = std::chrono::milliseconds(100);
constexpr Time kDrainCheck = std::chrono::milliseconds(1), kDrainWithin = std::chrono::seconds(5);

void watch(int events, int descriptor) {
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.fd = descriptor;
  epoll_ctl(events, EPOLL_CTL_ADD, descriptor, &event);
}

// Bytes that came before it must have left at the old rate, before the reset.
bool waits_for_drain(const Command& command) {
  return command.verb == kSb && (command.what == kBaudRate || command.what == kControl);
}

}  // namespace

Result<std::unique_ptr<PortServer>> PortServer::open(PortLink& board, const Options& options) {
  std::unique_ptr<PortServer> server(new PortServer(board, options));
  server->events_ = Descriptor(epoll_create1(EPOLL_CLOEXEC));
  if (!server->events_)
    return fail(Fault::environment,
                std::string("cannot wait for clients: ") + std::strerror(errno));
  server->listener_ = KAZ_TRY(listen_tcp(options.host, options.port));
  server->port_ = port_of(server->listener_.get());
  server->name_ = PortAddress{options.protocol == Protocol::raw ? PortKind::tcp : PortKind::rfc2217,
                              options.host, server->port_}
                      .name();
  watch(server->events_.get(), server->listener_.get());
  return server;
}

PortServer::PortServer(PortLink& board, const Options& options)
    : board_(board),
      options_(options),
      stream_("the client", "the client left", options.interrupt) {}

Result<void> PortServer::set_dtr_rts(bool, bool) {
  return fail(Fault::usage, name() + " is a server; its clients set DTR and RTS");
}

void PortServer::accept_clients() {
  const Time now = WallClock().now();
  if (leaving_ || now < accept_from_) return;
  if (!listening_) watch(events_.get(), listener_.get());
  listening_ = true;
  std::string peer;
  for (int i = 0; i < kMaxAccepted; ++i) {
    Descriptor client = accept_tcp(listener_.get(), peer);
    if (!client) return errno == EAGAIN ? void() : pause_accepting(now);
    if (has_client() && !uses_port()) displace_client();
    if (!has_client()) {
      begin_client(std::move(client), peer);
    } else {
      options_.report(peer + " was refused: " + peer_ + " has the port");  // and is closed
    }
  }
}

// Out of descriptors, for example: the listener stays readable although nothing can be done about it.
void PortServer::pause_accepting(Time now) {
  epoll_ctl(events_.get(), EPOLL_CTL_DEL, listener_.get(), nullptr);
  listening_ = false;
  accept_from_ = now + kAcceptPause;
}

bool PortServer::uses_port() const {
  return options_.protocol == Protocol::raw ? guard_.admitted() : negotiation_.com_port();
}

// Unless it begins to use the port by what it has sent already.
void PortServer::displace_client() {
  if (wire_.empty() && !command_) (void)receive();  // an interruption comes again in read()
  parse();
  if (has_client() && !uses_port())
    drop_client("was disconnected: it had not used the port, and another client came");
}

void PortServer::begin_client(Descriptor client, const std::string& peer) {
  peer_ = peer;
  guard_ = BrowserGuard(BrowserGuard::Peer::frames);
  reader_ = {};
  negotiation_ = {};
  warned_ = false;
  watch(events_.get(), client.get());
  stream_.attach(std::move(client));
  options_.report(peer_ + " has the port");
  if (options_.protocol == Protocol::raw) return;
  std::vector<std::uint8_t> wire;
  negotiation_.begin(End::server, wire);
  send(wire);
}

void PortServer::drop_client(std::string_view why) {
  stream_.detach();
  leaving_ = false;
  wire_.clear();
  data_.clear();
  command_.reset();
  options_.report(peer_ + " " + std::string(why));
}

// A client that takes no bytes is dropped by receive(), after its own last bytes: one may be a stop.
void PortServer::send(std::span<const std::uint8_t> wire) {
  if (leaving_ || stream_.write(wire)) return;
  leaving_ = true;
  stream_.drop_unsent();
  shutdown(stream_.descriptor(), SHUT_RDWR);  // what has come can still be read
}

// A client whose connection stands gets every byte that the board says from then on, even where
// this server did not come to accept it yet. By RFC 2217 it has to agree to option 44 first.
Result<void> PortServer::write(std::span<const std::uint8_t> bytes) {
  accept_clients();
  const bool raw = options_.protocol == Protocol::raw;
  if (!has_client() || !(raw || negotiation_.com_port())) return {};
  std::vector<std::uint8_t> wire;
  if (raw) {
    wire.assign(bytes.begin(), bytes.end());
  } else {
    put_data(bytes, wire);
  }
  send(wire);
  return {};
}

Result<std::size_t> PortServer::read(std::span<std::uint8_t> bytes, Time deadline) {
  const WallClock clock;
  while (true) {
    accept_clients();
    if (has_client() && data_.empty() && wire_.empty() && !command_) KAZ_TRY(receive());
    parse();
    if (!data_.empty()) {
      const std::size_t count = std::min(bytes.size(), data_.size());
      std::copy_n(data_.begin(), count, bytes.begin());
      data_.erase(data_.begin(), data_.begin() + static_cast<std::ptrdiff_t>(count));
      return count;
    }
    const Time now = clock.now();
    Time until = deadline;
    if (command_) until = std::min(until, now + kDrainCheck);
    if (!listening_) until = std::min(until, accept_from_);
    KAZ_TRY(wait_for(descriptor(), POLLIN, until, options_.interrupt, name()));
    if (now >= deadline) return 0;
  }
}

Result<void> PortServer::receive() {
  std::array<std::uint8_t, 4096> some;
  const auto count = stream_.read(some, WallClock().now());
  if (!count && count.error().fault == Fault::interrupted) return tl::unexpected(count.error());
  if (!count) {
    drop_client(leaving_ ? "left, or no longer reads the bytes sent to it" : "left");
  } else if (const auto admitted = guard_.admit(std::span(some).first(*count))) {
    wire_.assign(admitted->begin(), admitted->end());
  } else {
    drop_client(kBrowserRefused);
  }
  return {};
}

// Up to the next data, or to a command that waits.
void PortServer::parse() {
  std::span<const std::uint8_t> left = wire_;
  while (data_.empty()) {
    if (command_) {
      if (waits_for_drain(*command_) && !board_.drained()) {
        if (WallClock().now() < drain_by_) break;
        return drop_client(
            "was disconnected: the board's port did not send the client's bytes within 5 s");
      }
      obey(*std::exchange(command_, {}));
    }
    if (left.empty()) break;
    if (options_.protocol == Protocol::raw) {
      data_.assign(left.begin(), left.end());
      left = {};
    } else {
      command_ = reader_.take(left);
      drain_by_ = WallClock().now() + kDrainWithin;
      take_data();
    }
  }
  wire_.erase(wire_.begin(), wire_.end() - static_cast<std::ptrdiff_t>(left.size()));
}

void PortServer::take_data() {
  auto data = reader_.take_data();
  if (negotiation_.com_port()) {
    data_ = std::move(data);
  } else if (!data.empty() && !std::exchange(warned_, true)) {
    options_.report(peer_ +
                    " sent bytes before it agreed to RFC 2217 (telnet option 44); these bytes "
                    "were dropped: connect with rfc2217:, or serve the port with --raw");
  }
}

void PortServer::obey(const Command& command) {
  std::vector<std::uint8_t> answer;
  negotiation_.take(command, answer);
  if (command.verb == kSb && negotiation_.com_port()) set_port(command, answer);
  if (!answer.empty()) send(answer);
}

// What cannot be set is answered with what is. The board's line is 8N1 without handshake, always.
void PortServer::set_port(const Command& command, std::vector<std::uint8_t>& wire) {
  const auto answer = [&](std::span<const std::uint8_t> data) {
    put_com_port(static_cast<std::uint8_t>(command.what + kReply), data, wire);
  };
  const std::uint8_t value = command.data.empty() ? std::uint8_t{0} : command.data.front();
  switch (command.what) {
    case kSignature:
      if (command.data.empty()) answer({{'k', 'a', 'z'}});
      break;
    case kBaudRate: {
      const std::uint32_t baud = read_big_endian(command.data);
      if (baud > 0 && baud <= kMaxBaud && board_.set_baud(static_cast<int>(baud)))
        baud_ = static_cast<int>(baud);
      answer(big_endian(static_cast<std::uint32_t>(baud_)));
      break;
    }
    case kDataSize:
      answer({{8}});
      break;
    case kParity:
    case kStopSize:
      answer({{1}});
      break;
    case kControl:
      answer({{control(value)}});
      break;
    case kLineStateMask:
    case kModemStateMask:
      answer({{0}});
      break;
    case kPurge:
      board_.purge((value & kPurgeReceived) != 0, (value & kPurgeUnsent) != 0);
      answer({{value}});
      break;
    default:  // notices, suspend and resume: a frame is short, and nothing is held back
      break;
  }
}

std::uint8_t PortServer::control(std::uint8_t value) {
  if (value == kDtrOn || value == kDtrOff || value == kRtsOn || value == kRtsOff) {
    const bool dtr = value == kDtrOn || (value != kDtrOff && dtr_);
    const bool rts = value == kRtsOn || (value != kRtsOff && rts_);
    if (board_.set_dtr_rts(dtr, rts)) {
      dtr_ = dtr;
      rts_ = rts;
    }
  }
  switch (value) {
    case kQueryDtr:
    case kDtrOn:
    case kDtrOff:
      return dtr_ ? kDtrOn : kDtrOff;
    case kQueryRts:
    case kRtsOn:
    case kRtsOff:
      return rts_ ? kRtsOn : kRtsOff;
    case 4:  // break: asked for, on, off
    case 5:
    case 6:
      return 6;
    default:
      return kNoFlowControl;
  }
}

}  // namespace kaz::host
