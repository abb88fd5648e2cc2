// Accepts a client, and obeys what it says of rate and modem lines.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/port_server.h"

#include <poll.h>
#include <sys/epoll.h>

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

void watch(int events, int descriptor) {
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.fd = descriptor;
  epoll_ctl(events, EPOLL_CTL_ADD, descriptor, &event);
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
  std::string peer;
  while (Descriptor client = accept_tcp(listener_.get(), peer)) {
    if (has_client()) {
      options_.report(peer + " was refused: " + peer_ + " has the port");
      continue;  // closes it
    }
    peer_ = peer;
    reader_ = {};
    negotiation_ = {};
    data_.clear();
    watch(events_.get(), client.get());
    stream_.attach(std::move(client));
    options_.report(peer_ + " has the port");
    if (options_.protocol == Protocol::raw) continue;
    std::vector<std::uint8_t> wire;
    negotiation_.begin(wire);
    if (!stream_.write(wire)) drop_client("left");
  }
}

void PortServer::drop_client(const std::string& why) {
  stream_.detach();
  data_.clear();
  options_.report(peer_ + " " + why);
}

// A client whose connection stands gets every byte that the board says from then on, even where
// this server did not come to accept it yet.
Result<void> PortServer::write(std::span<const std::uint8_t> bytes) {
  accept_clients();
  if (!has_client()) return {};
  std::vector<std::uint8_t> wire;
  if (options_.protocol == Protocol::raw) {
    wire.assign(bytes.begin(), bytes.end());
  } else {
    put_data(bytes, wire);
  }
  if (!stream_.write(wire)) drop_client("left, or takes no bytes");
  return {};
}

Result<std::size_t> PortServer::read(std::span<std::uint8_t> bytes, Time deadline) {
  const WallClock clock;
  while (true) {
    if (!data_.empty()) {
      const std::size_t count = std::min(bytes.size(), data_.size());
      std::copy_n(data_.begin(), count, bytes.begin());
      data_.erase(data_.begin(), data_.begin() + static_cast<std::ptrdiff_t>(count));
      return count;
    }
    accept_clients();
    if (has_client()) {
      std::array<std::uint8_t, 4096> wire;
      const auto count = stream_.read(wire, clock.now());
      if (!count && count.error().fault == Fault::interrupted) return tl::unexpected(count.error());
      if (!count) {
        drop_client("left");
      } else if (*count > 0) {
        KAZ_TRY(take(std::span(wire).first(*count)));
        continue;
      }
    }
    const short ready =
        KAZ_TRY(wait_for(events_.get(), POLLIN, deadline, options_.interrupt, name()));
    if (ready == 0) return 0;
  }
}

Result<void> PortServer::take(std::span<const std::uint8_t> wire) {
  if (options_.protocol == Protocol::raw) {
    data_.insert(data_.end(), wire.begin(), wire.end());
    return {};
  }
  reader_.take(wire);
  std::vector<std::uint8_t> answer;
  for (const Command& command : reader_.take_commands()) {
    negotiation_.take(command, answer);
    if (command.verb == kSb) obey(command, answer);
  }
  const auto data = reader_.take_data();
  data_.insert(data_.end(), data.begin(), data.end());
  if (!answer.empty() && !stream_.write(answer)) drop_client("left");
  return {};
}

// What cannot be set is answered with what is. The board's line is 8N1 without handshake, always.
void PortServer::obey(const Command& command, std::vector<std::uint8_t>& wire) {
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
      if (value & 1) data_.clear();
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
    } else {
      return kNoFlowControl;  // a port without the lines: nothing that was asked for
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
