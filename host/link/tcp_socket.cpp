// getaddrinfo, connect and listen, none of which Ctrl-C has to wait for.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/tcp_socket.h"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <thread>

#include "host/link/byte_stream.h"
#include "host/link/wall_clock.h"

namespace kaz::host {

namespace {

// A peer that neither takes bytes nor answers probes for so long is gone.
constexpr int kPeerGone_ms = 1000, kProbe_s = 1;

using Addresses = std::unique_ptr<addrinfo, decltype(&freeaddrinfo)>;

Addresses look_up(const std::string& host, std::uint16_t port, int flags, int& error) {
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  wanted.ai_flags = flags | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  error = getaddrinfo(host.c_str(), std::to_string(port).c_str(), &wanted, &found);
  return {error == 0 ? found : nullptr, freeaddrinfo};
}

// A name server may be silent for many seconds, and nothing interrupts getaddrinfo: it runs in a thread that
// may outlive the call.
struct LookUp {
  std::string host;
  std::uint16_t port = 0;
  Descriptor done{eventfd(0, EFD_CLOEXEC)};
  int error = 0;
  Addresses found{nullptr, freeaddrinfo};
};

Result<Addresses> resolve(const std::string& name, const std::string& host, std::uint16_t port,
                          Time deadline, const Interrupt* interrupt) {
  int error = 0;
  if (auto found = look_up(host, port, AI_NUMERICHOST, error); found) return found;
  auto state = std::make_shared<LookUp>();
  state->host = host;
  state->port = port;
  std::thread([state] {
    state->found = look_up(state->host, state->port, 0, state->error);
    (void)eventfd_write(state->done.get(), 1);
  }).detach();
  const short ready = KAZ_TRY(wait_for(state->done.get(), POLLIN, deadline, interrupt, name));
  if (ready == 0)
    return fail(Fault::environment, name + ": no name server answers the query for " + host +
                                        ": give the host's IP address, such as 192.168.1.4");
  if (state->found) return std::move(state->found);
  return fail(Fault::environment,
              name + ": cannot find the host " + host + " (" + gai_strerror(state->error) +
                  "): check the host's name, or give its IP address, such as 192.168.1.4");
}

Error connect_failure(const std::string& name, int error) {
  switch (error) {
    case ECONNREFUSED:
      return {Fault::environment,
              name +
                  " refused the connection: no server listens on that port; start `kaz "
                  "serve-port`, ser2net or socat, or correct the port"};
    case EHOSTUNREACH:
    case ENETUNREACH:
      return {Fault::environment, name + " cannot be reached: check the network and the address (" +
                                      std::strerror(error) + ")"};
    case ETIMEDOUT:
      return {
          Fault::environment,
          name + " does not answer: the machine is off, or a firewall drops packets to that port"};
    default:
      return {Fault::environment, "cannot connect to " + name + ": " + std::strerror(error)};
  }
}

void make_prompt(int socket) {
  const int on = 1, probes = 2;
  setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  setsockopt(socket, SOL_SOCKET, SO_KEEPALIVE, &on, sizeof on);
  setsockopt(socket, IPPROTO_TCP, TCP_KEEPIDLE, &kProbe_s, sizeof kProbe_s);
  setsockopt(socket, IPPROTO_TCP, TCP_KEEPINTVL, &kProbe_s, sizeof kProbe_s);
  setsockopt(socket, IPPROTO_TCP, TCP_KEEPCNT, &probes, sizeof probes);
  setsockopt(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, &kPeerGone_ms, sizeof kPeerGone_ms);
}

Result<Descriptor> connect_one(const std::string& name, const addrinfo& to, Time deadline,
                               const Interrupt* interrupt) {
  Descriptor fd(socket(to.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!fd) return tl::unexpected(connect_failure(name, errno));
  make_prompt(fd.get());
  if (connect(fd.get(), to.ai_addr, to.ai_addrlen) == 0) return fd;
  if (errno != EINPROGRESS && errno != EINTR) return tl::unexpected(connect_failure(name, errno));
  const short ready = KAZ_TRY(wait_for(fd.get(), POLLOUT, deadline, interrupt, name));
  int error = ready == 0 ? ETIMEDOUT : 0;
  socklen_t size = sizeof error;
  if (ready != 0) getsockopt(fd.get(), SOL_SOCKET, SO_ERROR, &error, &size);
  if (error == 0) return fd;
  return tl::unexpected(connect_failure(name, error));
}

std::string text_of(const sockaddr* address, socklen_t size) {
  char host[NI_MAXHOST] = {}, port[NI_MAXSERV] = {};
  getnameinfo(address, size, host, sizeof host, port, sizeof port, NI_NUMERICHOST | NI_NUMERICSERV);
  const bool v6 = std::strchr(host, ':') != nullptr;
  std::string text = v6 ? "[" : "";
  text.append(host).append(v6 ? "]:" : ":").append(port);
  return text;
}

}  // namespace

Result<Descriptor> connect_tcp(const std::string& name, const std::string& host, std::uint16_t port,
                               Time patience, const Interrupt* interrupt) {
  const Time deadline = WallClock().now() + patience;
  const auto addresses = KAZ_TRY(resolve(name, host, port, deadline, interrupt));
  Result<Descriptor> connected = tl::unexpected(connect_failure(name, EHOSTUNREACH));
  for (const addrinfo* one = addresses.get(); one != nullptr; one = one->ai_next) {
    connected = connect_one(name, *one, deadline, interrupt);
    if (connected || connected.error().fault == Fault::interrupted) break;
  }
  return connected;
}

Result<Descriptor> listen_tcp(const std::string& host, std::uint16_t port) {
  const std::string place = host + ":" + std::to_string(port);
  int error = 0;
  const auto addresses = look_up(host, port, AI_PASSIVE, error);
  if (!addresses)
    return fail(Fault::usage,
                "cannot listen on " + host + " (" + gai_strerror(error) +
                    "): give 127.0.0.1, or an address that the command `ip address` lists");
  Descriptor fd(socket(addresses->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const int on = 1;
  setsockopt(fd.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (bind(fd.get(), addresses->ai_addr, addresses->ai_addrlen) == 0 && listen(fd.get(), 4) == 0)
    return fd;
  if (errno == EADDRINUSE)
    return fail(Fault::environment,
                "another program listens on " + place + ": end that program, or give another port");
  if (errno == EACCES)
    return fail(Fault::environment,
                "port " + std::to_string(port) +
                    ": only root may listen on ports below 1024; give another port");
  if (errno == EADDRNOTAVAIL)
    return fail(
        Fault::usage,
        host +
            " is not an address of this machine: give 127.0.0.1, or an address that the command "
            "`ip address` lists");
  return fail(Fault::environment, "cannot listen on " + place + ": " + std::strerror(errno));
}

Descriptor accept_tcp(int listener, std::string& peer) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  auto* const from = reinterpret_cast<sockaddr*>(&address);
  Descriptor fd(accept4(listener, from, &size, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (!fd) return fd;
  make_prompt(fd.get());
  peer = text_of(from, size);
  return fd;
}

std::uint16_t port_of(int listener) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.ss_family == AF_INET6
                   ? reinterpret_cast<const sockaddr_in6&>(address).sin6_port
                   : reinterpret_cast<const sockaddr_in&>(address).sin_port);
}

}  // namespace kaz::host
