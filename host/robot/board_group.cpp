// Splitting requests by joints, collecting the replies of all boards.
// SPDX-License-Identifier: Apache-2.0
#include "host/robot/board_group.h"

#include <algorithm>
#include <utility>

#include "host/robot/board_group_parts.h"
#include "host/robot/typed_request.h"
#include "shared/protocol/message_info.h"

namespace kaz::host {

namespace {

template <class Message>
std::optional<Message> unpacked(const Request& request, u8 (*unpack)(Message*, const u8*, u8)) {
  Message message{};
  if (!unpack(&message, request.fields.bytes.data(), request.fields.length)) return std::nullopt;
  return message;
}

// The request for the joints of `joints` alone; nothing if it has none of them.
template <class Message>
std::optional<Request> masked(const Request& request, std::uint32_t joints,
                              u8 (*pack)(const Message*, u8*),
                              u8 (*unpack)(Message*, const u8*, u8)) {
  auto message = unpacked(request, unpack);
  if (!message) return request;
  message->mask &= joints;
  if (message->mask == 0 && request.type != KZ_TYPE_enable) return std::nullopt;
  return make_request(request.type, *message, pack);
}

template <class Message>
std::optional<Request> of_joint(const Request& request, std::uint32_t joints,
                                u8 (*unpack)(Message*, const u8*, u8)) {
  const auto message = unpacked(request, unpack);
  if (message && (joints >> message->joint & 1) == 0) return std::nullopt;
  return request;
}

Request heartbeat() {
  return make_request(KZ_TYPE_heartbeat, kz_heartbeat{}, kz_pack_heartbeat);
}

}  // namespace

// What Robot sees as the link: names all, and opens again those that failed.
class BoardGroup::Links final : public Link {
 public:
  explicit Links(BoardGroup& group) : group_(group) {}
  std::string name() const override {
    std::string text;
    for (const auto& member : group_.members_) {
      const std::string one = member->board.link->name();
      if (text.find(one) == std::string::npos) text += (text.empty() ? "" : " and ") + one;
    }
    return text;
  }
  Result<void> write(std::span<const std::uint8_t>) override { return no_bytes(); }
  Result<std::size_t> read(std::span<std::uint8_t>, Time) override {
    return tl::unexpected(no_bytes().error());
  }
  Result<void> reopen() override {
    for (const auto& member : group_.members_) {
      if (!member->link_lost) continue;
      KAZ_TRY(member->board.link->reopen());
      member->link_lost = false;
    }
    return {};
  }

 private:
  static Result<void> no_bytes() {
    return fail(Fault::usage,
                "raw bytes can only be exchanged with one board: give the port of one board");
  }
  BoardGroup& group_;
};

BoardGroup::BoardGroup(std::vector<RobotBoard> boards, Clock& clock, int retries) {
  for (const RobotBoard& board : boards)
    members_.push_back(std::make_unique<Member>(board, clock, retries));
  links_ = std::make_unique<Links>(*this);
}

BoardGroup::~BoardGroup() = default;

// Nothing: the request does not concern this board.
std::optional<Request> BoardGroup::part_of(const Request& request, const Member& member) const {
  const std::uint32_t joints = member.board.joints;
  switch (request.type) {
    case KZ_TYPE_enable:
      return masked(request, joints, kz_pack_enable, kz_unpack_enable);
    case KZ_TYPE_targets:
      return masked(request, joints, kz_pack_targets, kz_unpack_targets);
    case KZ_TYPE_read_targets:
      return masked(request, joints, kz_pack_read_targets, kz_unpack_read_targets);
    case KZ_TYPE_joints:
      return masked(request, joints, kz_pack_joints, kz_unpack_joints);
    case KZ_TYPE_gains:
      return masked(request, joints, kz_pack_gains, kz_unpack_gains);
    case KZ_TYPE_limits:
      return masked(request, joints, kz_pack_limits, kz_unpack_limits);
    case KZ_TYPE_calibrate:
      return masked(request, joints, kz_pack_calibrate, kz_unpack_calibrate);
    case KZ_TYPE_settings:
      return of_joint(request, joints, kz_unpack_settings);
    case KZ_TYPE_raw_drive:
      return of_joint(request, joints, kz_unpack_raw_drive);
    default:
      return request;
  }
}

void BoardGroup::note_enabled(const Request& request) {
  const bool off = request.type == KZ_TYPE_stop || request.type == KZ_TYPE_reset ||
                   request.type == KZ_TYPE_loader;
  const auto enable = request.type == KZ_TYPE_enable ? unpacked(request, kz_unpack_enable)
                                                     : std::optional<kz_enable>();
  for (const auto& member : members_) {
    if (off) member->to_be_on = 0;
    if (enable) member->to_be_on = enable->mask & member->board.joints;
    if (enable) member->to_be_off = false;
  }
}

Result<Exchanger::Ticket> BoardGroup::post(const Request& request) {
  if (request.type == KZ_TYPE_telemetry || request.type == KZ_TYPE_set_address)
    return fail(Fault::usage,
                std::string("`") + message_name(request.type) +
                    "` is only valid for one board: give the port and address of one board on " +
                    links_->name());
  note_enabled(request);
  auto exchange = std::make_unique<Exchange>();
  exchange->request = request;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    const auto part = part_of(request, *members_[i]);
    const auto ticket = members_[i]->requester.post(part.value_or(heartbeat()));
    if (!ticket) {
      Error error = blame(i, ticket.error());
      // The boards that are still there go off now, and not when the lost one is back.
      const auto enable = request.type == KZ_TYPE_enable ? unpacked(request, kz_unpack_enable)
                                                         : std::optional<kz_enable>();
      if (enable && enable->mask == 0) switch_off();
      return tl::unexpected(std::move(error));
    }
    exchange->parts.push_back({part.has_value(), *ticket, std::nullopt});
  }
  open_.emplace(next_ticket_, std::move(exchange));
  return next_ticket_++;
}

Result<std::optional<Reply>> BoardGroup::collect(Ticket ticket, Time deadline) {
  const auto found = open_.find(ticket);
  if (found == open_.end())
    return fail(Fault::failed, "the reply was discarded when the link to one of the boards on " +
                                   links_->name() + " failed");
  Exchange& exchange = *found->second;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    auto& part = exchange.parts[i];
    if (part.reply) continue;
    auto reply = members_[i]->requester.collect(part.ticket, deadline);
    if (!reply) return tl::unexpected(blame(i, reply.error()));
    if (!*reply) return std::nullopt;
    part.reply = std::move(**reply);
    members_[i]->relate(part.concerned ? exchange.request.type : std::uint8_t{KZ_TYPE_heartbeat},
                        *part.reply);
  }
  const std::unique_ptr<Exchange> whole = std::move(found->second);
  open_.erase(found);
  return merge(*whole);
}

// Nothing is under way any more. The sentence says which of the boards it was.
Error BoardGroup::blame(std::size_t index, Error error) {
  open_.clear();
  failed_ = index;
  Member& member = *members_[index];
  member.link_lost = !member.requester.timed_out() && error.fault == Fault::environment;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    if (i != index) members_[i]->requester.start_anew();
  }
  if (error.fault == Fault::environment)
    error.message += " (the board with address " + std::to_string(member.board.address) + ", for " +
                     joint_names_of(member.board.joints) + ")";
  return error;
}

Result<std::vector<Reply>> BoardGroup::exchange(std::span<const Request> requests) {
  std::vector<Ticket> tickets;
  for (const Request& request : requests) tickets.push_back(KAZ_TRY(post(request)));
  std::vector<Reply> replies;
  for (const Ticket ticket : tickets) {
    auto reply = KAZ_TRY(collect(ticket, Time::max()));
    replies.push_back(std::move(*reply));
  }
  return replies;
}

// First to all, so that none waits for the reply of another.
Result<Reply> BoardGroup::exchange_at_once(const Request& request) {
  note_enabled(request);
  for (const auto& member : members_) (void)member->requester.send(request);
  Exchange exchange;
  exchange.request = request;
  std::optional<Error> error;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    auto reply = members_[i]->requester.exchange_at_once(request);
    if (!reply && !error) error = blame(i, reply.error());
    if (reply) members_[i]->relate(request.type, *reply);
    exchange.parts.push_back({true, 0, reply ? std::optional(*reply) : std::nullopt});
  }
  if (error) return tl::unexpected(*error);
  return merge(exchange);
}

Result<void> BoardGroup::send(const Request& request) {
  note_enabled(request);
  Result<void> sent;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    const auto part = part_of(request, *members_[i]);
    if (auto one = members_[i]->requester.send(part.value_or(heartbeat())); !one && sent)
      sent = tl::unexpected(blame(i, one.error()));
  }
  return sent;
}

Result<bool> BoardGroup::listen(Time deadline) {
  return members_.front()->requester.listen(deadline);
}

void BoardGroup::start_anew() {
  open_.clear();
  for (const auto& member : members_) {
    member->requester.start_anew();
    member->before.reset();
    member->latest.reset();
    member->last_tick.reset();
    member->restarted = false;
  }
}

void BoardGroup::limit_tries(std::optional<int> tries) {
  for (const auto& member : members_) member->requester.limit_tries(tries);
}

const LinkStatistics& BoardGroup::statistics() const {
  statistics_ = {};
  for (const auto& member : members_) {
    const LinkStatistics& one = member->requester.statistics();
    statistics_.requests += one.requests;
    statistics_.replies += one.replies;
    statistics_.refused += one.refused;
    statistics_.bad_frames += one.bad_frames;
    statistics_.timeouts += one.timeouts;
    statistics_.retries += one.retries;
    statistics_.busy += one.busy;
    statistics_.ignored += one.ignored;
    statistics_.telemetry += one.telemetry;
    statistics_.bytes_out += one.bytes_out;
    statistics_.bytes_in += one.bytes_in;
    if (one.round_trip.last_s >= statistics_.round_trip.last_s)
      statistics_.round_trip = one.round_trip;
  }
  return statistics_;
}

std::string BoardGroup::recent_frames() const {
  std::string text;
  for (const auto& member : members_)
    text += member->board.link->name() + ", address " + std::to_string(member->board.address) +
            ":\n" + member->requester.recent_frames();
  return text;
}

Link& BoardGroup::link() {
  return *links_;
}
std::string BoardGroup::failed_name() {
  const RobotBoard& board = members_[failed_]->board;
  return board.link->name() + ", address " + std::to_string(board.address);
}
std::span<const std::uint8_t> BoardGroup::noise() const {
  return members_[failed_]->requester.noise();
}
bool BoardGroup::timed_out() const {
  return members_[failed_]->requester.timed_out() && !members_[failed_]->link_lost;
}
bool BoardGroup::heard_echo() const {
  return members_[failed_]->requester.heard_echo();
}
Time BoardGroup::last_sent() const {
  Time oldest = Time::max();
  for (const auto& member : members_) oldest = std::min(oldest, member->requester.last_sent());
  return oldest;
}

std::string joint_names_of(std::uint32_t joints) {
  std::string text;
  for (int j = 0; j < KZ_JOINTS; ++j) {
    if (joints >> j & 1)
      text +=
          (text.empty() ? "" : ", ") + std::string(joint_table()[static_cast<std::size_t>(j)].name);
  }
  return text;
}

Result<void> check_boards(std::span<const RobotBoard> boards) {
  std::uint32_t all = 0;
  for (const RobotBoard& board : boards) {
    if (board.joints == 0 || (board.joints & ~kAllJoints) != 0)
      return fail(Fault::usage,
                  "each board must have at least one joint, and only joints that Kaz has: give the "
                  "joints of each board");
    if (const std::uint32_t twice = all & board.joints)
      return fail(Fault::usage,
                  "two boards drive " + joint_names_of(twice) + ": assign each joint to one board");
    all |= board.joints;
  }
  if (all != kAllJoints)
    return fail(Fault::usage, "no board drives " + joint_names_of(kAllJoints & ~all) +
                                  ": assign each joint to a board");
  return {};
}

}  // namespace kaz::host
