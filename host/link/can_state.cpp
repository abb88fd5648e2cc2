// One question of rtnetlink(7), and the attributes of its answer.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/can_state.h"

#include <linux/can/netlink.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/socket.h>

#include <array>
#include <cstring>

#include "shared/base/descriptor.hpp"

namespace kaz::host {

namespace {

// Calls `take` for each attribute from `first` on.
template <class Take>
void for_each(const rtattr* first, int length, Take take) {
  for (const rtattr* one = first; RTA_OK(one, length); one = RTA_NEXT(one, length)) take(*one);
}

template <class Take>
void for_each_in(const rtattr& nest, Take take) {
  for_each(static_cast<const rtattr*>(RTA_DATA(&nest)), static_cast<int>(RTA_PAYLOAD(&nest)), take);
}

template <class Number>
std::optional<Number> number_of(const rtattr& one) {
  Number value{};
  if (RTA_PAYLOAD(&one) < sizeof value) return std::nullopt;
  std::memcpy(&value, RTA_DATA(&one), sizeof value);
  return value;
}

void take_controller(const rtattr& info, CanState& state) {
  for_each_in(info, [&](const rtattr& data) {
    if (data.rta_type != IFLA_INFO_DATA) return;
    for_each_in(data, [&](const rtattr& one) {
      if (one.rta_type == IFLA_CAN_STATE) state.controller = number_of<std::uint32_t>(one);
    });
  });
}

}  // namespace

bool CanState::bus_off() const {
  return controller ? *controller == CAN_STATE_BUS_OFF : !carrier;
}

std::optional<CanState> can_state(unsigned index) {
  const Descriptor fd(socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE));
  struct {
    nlmsghdr header;
    ifinfomsg link;
  } question{};
  question.header.nlmsg_len = sizeof question;
  question.header.nlmsg_type = RTM_GETLINK;
  question.header.nlmsg_flags = NLM_F_REQUEST;
  question.link.ifi_index = static_cast<int>(index);
  if (send(fd.get(), &question, sizeof question, 0) != static_cast<ssize_t>(sizeof question))
    return std::nullopt;
  // The kernel has answered when send() returns.
  alignas(nlmsghdr) std::array<char, 1 << 15> answer;
  const ssize_t size = recv(fd.get(), answer.data(), answer.size(), MSG_DONTWAIT);
  const auto* header = reinterpret_cast<const nlmsghdr*>(answer.data());
  if (size < 0 || !NLMSG_OK(header, static_cast<unsigned>(size)) ||
      header->nlmsg_type != RTM_NEWLINK)
    return std::nullopt;
  const auto* link = static_cast<const ifinfomsg*>(NLMSG_DATA(header));
  CanState state;
  state.up = (link->ifi_flags & IFF_UP) != 0;
  for_each(IFLA_RTA(link), static_cast<int>(IFLA_PAYLOAD(header)), [&](const rtattr& one) {
    if (one.rta_type == IFLA_CARRIER) state.carrier = number_of<std::uint8_t>(one).value_or(1) != 0;
    if (one.rta_type == IFLA_LINKINFO) take_controller(one, state);
  });
  return state;
}

}  // namespace kaz::host
