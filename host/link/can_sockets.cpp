// SocketCAN: ISO-TP and error frames of one interface, with a sentence for each cause of failure.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/can_sockets.h"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/isotp.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <map>
#include <utility>

#include "host/link/can_state.h"

namespace kaz::host {

namespace {

constexpr int kReceiveBuffer = 1 << 20;  // bytes; the default loses frames of a burst

tl::unexpected<Error> no_protocol(const char* what, const char* module, int error) {
  if (error == EPERM || error == EACCES)
    return fail(
        Fault::environment,
        std::string("permission denied for a ") + what +
            " socket: this container or sandbox forbids CAN; run kaz outside the container");
  return fail(Fault::environment,
              std::string("this kernel has no ") + what + ": `sudo modprobe " + module +
                  "` loads the module; Debian's full kernel (linux-image-amd64) has this module, "
                  "but the cloud kernel does not");
}

class KernelCanSockets final : public CanSockets {
 public:
  explicit KernelCanSockets(std::string interface) : interface_(std::move(interface)) {}
  std::string interface() const override { return interface_; }

  Result<void> check() override {
    const Descriptor any(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    ifreq request{};
    interface_.copy(request.ifr_name, IFNAMSIZ - 1);
    if (ioctl(any.get(), SIOCGIFHWADDR, &request) != 0)
      return fail(Fault::environment,
                  "no such CAN interface: " + interface_ + " (" + candidates() + ")");
    if (request.ifr_hwaddr.sa_family != ARPHRD_CAN)
      return fail(
          Fault::environment,
          interface_ + " is a network interface, but not a CAN interface (" + candidates() + ")");
    if (ioctl(any.get(), SIOCGIFFLAGS, &request) != 0 || (request.ifr_flags & IFF_UP) == 0)
      return fail(Fault::environment,
                  "the CAN interface " + interface_ + " is down: run `sudo ip link set " +
                      interface_ +
                      " up type can bitrate 1000000 restart-ms 100`, but replace 1000000 with the "
                      "bit rate of the bus; for a virtual interface, run `sudo ip link set " +
                      interface_ + " up`");
    const auto state = can_state(if_nametoindex(interface_.c_str()));
    if (state && state->bus_off())
      return fail(Fault::environment, "the CAN interface " + interface_ +
                                          " is bus-off: check wiring, termination (120 ohm at both "
                                          "ends) and bit rate; if restart-ms is set, the interface "
                                          "restarts by itself; if restart-ms is not set, run `sudo "
                                          "ip link set " +
                                          interface_ + " type can restart`");
    return {};
  }

  Result<Descriptor> open_isotp(const IsoTpChannel& channel) override {
    KAZ_TRY(lock(channel));
    Descriptor fd(socket(PF_CAN, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_ISOTP));
    if (!fd) return no_protocol("CAN ISO-TP", "can-isotp", errno);
    can_isotp_options options{};
    if (channel.mode == IsoTpChannel::Mode::broadcast) options.flags = CAN_ISOTP_CF_BROADCAST;
    if (channel.mode == IsoTpChannel::Mode::listen) options.flags = CAN_ISOTP_LISTEN_MODE;
    setsockopt(fd.get(), SOL_CAN_ISOTP, CAN_ISOTP_OPTS, &options, sizeof options);
    setsockopt(fd.get(), SOL_SOCKET, SO_RCVBUF, &kReceiveBuffer, sizeof kReceiveBuffer);
    sockaddr_can address = KAZ_TRY(address_of());
    address.can_addr.tp.tx_id = channel.tx_id;
    address.can_addr.tp.rx_id = channel.rx_id;
    return bound(std::move(fd), address);
  }

  Result<Descriptor> open_errors() override {
    Descriptor fd(socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW));
    if (!fd) return no_protocol("CAN", "can-raw", errno);
    const can_err_mask_t all = CAN_ERR_MASK;
    setsockopt(fd.get(), SOL_CAN_RAW, CAN_RAW_FILTER, nullptr, 0);
    setsockopt(fd.get(), SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &all, sizeof all);
    const sockaddr_can address = KAZ_TRY(address_of());
    return bound(std::move(fd), address);
  }

 private:
  static std::string candidates() {
    std::string text;
    struct if_nameindex* all = if_nameindex();
    const Descriptor any(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    for (auto* one = all; one != nullptr && one->if_index != 0; ++one) {
      ifreq request{};
      std::strncpy(request.ifr_name, one->if_name, IFNAMSIZ - 1);
      if (ioctl(any.get(), SIOCGIFHWADDR, &request) == 0 &&
          request.ifr_hwaddr.sa_family == ARPHRD_CAN)
        text += (text.empty() ? "CAN interfaces found: " : ", ") + std::string(one->if_name);
    }
    if (all != nullptr) if_freenameindex(all);
    return text.empty() ? "no CAN interface was found: plug the adapter in, or create a virtual "
                          "one with `sudo modprobe vcan` and `sudo ip link add vcan0 type vcan`"
                        : text;
  }

  Result<sockaddr_can> address_of() {
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(if_nametoindex(interface_.c_str()));
    if (address.can_ifindex == 0)
      return fail(Fault::environment,
                  "no such CAN interface: " + interface_ + " (" + candidates() + ")");
    return address;
  }

  Result<Descriptor> bound(Descriptor fd, const sockaddr_can& address) {
    if (bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return fd;
    return fail(Fault::environment,
                "cannot use the CAN interface " + interface_ + ": " + std::strerror(errno));
  }

  // CAN sockets exclude nobody, and two receivers with one identifier would both send flow control. The name
  // of an abstract socket is free again when its process has ended, however it did.
  Result<void> lock(const IsoTpChannel& channel) {
    const bool listens = channel.mode == IsoTpChannel::Mode::listen;
    if (listens || locks_.count(channel.tx_id) > 0) return {};
    Descriptor fd(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const int length = std::snprintf(address.sun_path + 1, sizeof address.sun_path - 1,
                                     "kaz/can/%s/%03x", interface_.c_str(), channel.tx_id);
    const auto size =
        static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + static_cast<unsigned>(length));
    if (bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), size) != 0) {
      char id[16];
      std::snprintf(id, sizeof id, "0x%03x", channel.tx_id);
      return fail(Fault::environment, "can:" + interface_ +
                                          " is in use: another program sends frames with the id " + id +
                                          "; end that program first");
    }
    locks_.emplace(channel.tx_id, std::move(fd));
    return {};
  }

  std::string interface_;
  std::map<std::uint32_t, Descriptor> locks_;
};

}  // namespace

std::unique_ptr<CanSockets> kernel_can_sockets(const std::string& interface) {
  return std::make_unique<KernelCanSockets>(interface);
}

}  // namespace kaz::host
