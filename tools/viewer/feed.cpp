// What viewers get beside the recorded channels.
// SPDX-License-Identifier: Apache-2.0
#include "tools/viewer/feed.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "shared/base/number_text.hpp"
#include "shared/protocol/message_info.h"
#include "shared/protocol/messages.h"
#include "sim/board/servo_board.h"
#include "sim/body/description/urdf_writer.h"
#include "sim/runtime/formats/ros_messages.h"

namespace kaz::viewer {
namespace {

using sim::LittleEndian;
using sim::LittleEndianFields;
using sim::ros::header;

constexpr char kJointState[] =
    "# True angles and the motors' torques.\nstd_msgs/Header header\nstring[] name\n"
    "float64[] position\nfloat64[] velocity\nfloat64[] effort\n" KAZ_ROS_STD_HEADER;
constexpr char kBoard[] =
    "# Messages between host and board, and states of the pins; indices are joint numbers.\n"
    "std_msgs/Header header\n"
    "string[18] name\n"
    "float64[18] target    # rad, in the last request that named the joint\n"
    "float64[18] measured  # rad, potentiometer angles in the board's last reply\n"
    "float64[18] duty      # -1 to 1, at the PWM pins\n"
    "uint16 status         # KZ_STATUS_* flags, and the reason of a shutdown in the upper byte\n"
    "string shutdown       # reason of the shutdown; empty: no shutdown\n"
    "float64 supply_v      # as the board measures it\n"
    "float64 worst_tick    # longest tick in the board's last statistics, share of a "
    "tick's period; 0: no statistics yet\n"
    "uint32 frames_to_board\nuint32 frames_to_host\n"
    "uint32 frames_damaged # damaged frames, sum of both directions\n" KAZ_ROS_STD_HEADER;

constexpr std::string_view kWire = "/wire/";

}  // namespace

Result<Feed> Feed::create(Server& server, const std::string& robot_path,
                          const FeedOptions& options) {
  auto model = KAZ_TRY(sim::load_robot(robot_path, {.skip_missing_meshes = true}));
  std::string urdf;
  if (!options.recorded_robot) urdf = KAZ_TRY(sim::robot_urdf(robot_path, &model));
  Feed feed(server, std::move(model), options);
  if (options.recorded_robot) return feed;
  LittleEndian(feed.data_).text(urdf);
  server.publish(feed.channels_.description, 0, feed.data_, {.kept = true});
  return feed;
}

Feed::Channels Feed::add_channels(Server& server, bool recorded_robot) {
  const auto add = [&server](const char* topic, const char* name, const char* schema,
                             bool derived = true) {
    return server.add_channel({0, topic, "ros1", name, "ros1msg", schema}, derived);
  };
  // The recording has these of a simulated robot.
  const bool derived = !recorded_robot;
  Channels all{};
  all.tf = add("/tf", "tf2_msgs/TFMessage", sim::ros::kTransforms, derived);
  all.joint_states = add("/joint_states", "sensor_msgs/JointState", kJointState);
  all.description = add("/robot_description", "std_msgs/String", sim::ros::kText, derived);
  add("/scene", "visualization_msgs/MarkerArray", sim::ros::kMarkers, derived);
  add("/contacts", "visualization_msgs/MarkerArray", sim::ros::kMarkers, derived);
  all.board = add("/board/state", "kaz/BoardState", kBoard);
  return all;
}

Feed::Feed(Server& server, sim::RobotModel model, const FeedOptions& options)
    : server_(server),
      poses_(std::move(model), options.hangs),
      channels_(add_channels(server, options.recorded_robot)),
      pictures_(server),
      rate_{.period_ns = static_cast<std::uint64_t>(1e9 / options.rate_hz)},
      posed_(options.recorded_robot) {}

void Feed::restart() {
  rate_.next_ns.reset();
  wire_.lines.clear();
  board_.frames_to_board = board_.frames_to_host = board_.frames_damaged = 0;
  board_.worst_tick = 0;
}

bool Feed::Rate::due(std::uint64_t time_ns) {
  if (next_ns && time_ns < *next_ns) return false;
  next_ns = time_ns - time_ns % period_ns + period_ns;
  return true;
}

Feed::Use Feed::use_of(std::string_view topic) {
  if (topic.starts_with(kWire) || topic == "/tf") return Use::always;
  return topic == "/truth/joints" || topic == "/board/pins" ? Use::for_viewers : Use::never;
}

void Feed::message(std::string_view topic, std::uint64_t time_ns,
                   std::span<const std::uint8_t> data) {
  if (topic == "/truth/joints") return joints(time_ns, data);
  if (topic.starts_with(kWire)) {
    const std::string_view end = topic.substr(kWire.size());
    // /wire/to_host, and of the second board /wire/2/to_host
    const std::size_t slash = end.find('/');
    const auto line = slash == std::string_view::npos
                          ? std::optional<std::size_t>(1)
                          : parse_number<std::size_t>(end.substr(0, slash));
    if (line && *line >= 1 && *line <= KZ_JOINTS)
      wire(time_ns, *line - 1, end.ends_with("to_board"), data);
    return;
  }
  if (topic == "/tf") posed_ = true;
  if (topic != "/board/pins" || !server_.wanted(channels_.board)) return;
  LittleEndianFields fields(data);
  sim::PinLevels pins;
  for (auto& counts : pins.pw) counts = fields.number<std::uint16_t>();
  for (auto& counts : pins.tmo) counts = fields.number<std::uint16_t>();
  for (auto* port : {&pins.p3, &pins.p4, &pins.p5, &pins.p6}) *port = fields.number<std::uint8_t>();
  if (!fields.good()) return;
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) board_.duty[j] = sim::duty_of(pins, j);
}

void Feed::joints(std::uint64_t time_ns, std::span<const std::uint8_t> data) {
  if (!rate_.due(time_ns)) return;
  LittleEndianFields fields(data);
  for (double& angle : angle_) angle = std::bit_cast<double>(fields.number<std::uint64_t>());
  for (double& torque : torque_) torque = std::bit_cast<double>(fields.number<std::uint64_t>());
  if (!fields.good()) return;
  has_truth_ = true;
  server_.publish_time(time_ns);
  joint_states(time_ns, angle_, torque_);
  board_state(time_ns);
  if (!posed_) poses_of_joints(time_ns);
}

// A board's state, where no simulator states more. The robot stands on its lower foot: where its trunk is
// nobody knows.
void Feed::measured(std::uint64_t time_ns) {
  if (has_truth_ || !rate_.due(time_ns)) return;
  server_.publish_time(time_ns);
  joint_states(time_ns, board_.measured, {});
  board_state(time_ns);
  angle_ = board_.measured;
  poses_of_joints(time_ns);
}

// Without `torques` none are stated.
void Feed::joint_states(std::uint64_t time_ns, std::span<const double> angles,
                        std::span<const double> torques) {
  if (!server_.wanted(channels_.joint_states)) return;
  data_.clear();
  LittleEndian to(data_);
  const std::size_t count = std::min<std::size_t>(KZ_JOINTS, poses_.model().motors());
  const auto size = static_cast<std::uint32_t>(count);
  header(to, time_ns, "").number(size);
  for (std::size_t j = 0; j < count; ++j) to.text(poses_.model().joints[j].name);
  to.number(size).reals(angles.first(count));
  to.number(std::uint32_t{0});
  if (torques.empty()) {
    to.number(std::uint32_t{0});
  } else {
    to.number(size).reals(torques.first(count));
  }
  server_.publish(channels_.joint_states, time_ns, data_);
}

void Feed::board_state(std::uint64_t time_ns) {
  if (!server_.wanted(channels_.board)) return;
  data_.clear();
  LittleEndian to(data_);
  header(to, time_ns, "");
  for (std::size_t j = 0; j < KZ_JOINTS; ++j)
    to.text(j < poses_.model().motors() ? poses_.model().joints[j].name : std::string());
  to.reals(board_.target).reals(board_.measured).reals(board_.duty);
  const auto reason = static_cast<u8>(board_.status >> 8);
  to.number(board_.status).text(reason == 0 ? "" : kz_shutdown_text(reason)).real(board_.supply_v);
  to.real(board_.worst_tick)
      .number(board_.frames_to_board)
      .number(board_.frames_to_host)
      .number(board_.frames_damaged);
  server_.publish(channels_.board, time_ns, data_);
}

// A shutdown is published at once: the run may end by it.
void Feed::set_status(std::uint64_t time_ns, std::uint16_t status) {
  const bool other_reason = status >> 8 != board_.status >> 8;
  board_.status = status;
  if (other_reason) board_state(time_ns);
}

void Feed::wire(std::uint64_t time_ns, std::size_t line, bool to_board,
                std::span<const std::uint8_t> data) {
  LittleEndianFields fields(data);
  const auto values = fields.array();
  while (wire_.lines.size() <= line) {
    for (kz_receiver& receiver : wire_.lines.emplace_back().receivers) kz_receiver_init(&receiver);
  }
  kz_receiver& receiver = wire_.lines[line].receivers[to_board ? 0 : 1];
  const auto radians = [](s16 angle) {
    return static_cast<double>(angle) / static_cast<double>(KZ_ANGLE_PER_RAD);
  };
  const auto take = [&](const auto& state) {
    for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
      if (wire_.line_of[j] == line) board_.measured[j] = radians(state.angle[j]);
    }
    if (line == 0 || state.status != 0) set_status(time_ns, state.status);
    if (line == 0) board_.supply_v = state.supply_mv * 1e-3;
    measured(time_ns);
  };
  const auto mine = [&](std::uint32_t mask, std::size_t j) {
    return (mask >> j & 1) != 0 && wire_.line_of[j] == line;
  };
  for (const std::uint8_t value : values) {
    const u8 result = kz_receive(&receiver, value, 0);
    // Below KZ_RECEIVE_BAD_CHECK there is nothing yet, or a frame.
    if (result >= KZ_RECEIVE_BAD_CHECK) ++board_.frames_damaged;
    if (result != KZ_RECEIVE_FRAME || receiver.length < KZ_HEADER_SIZE) continue;
    ++(to_board ? board_.frames_to_board : board_.frames_to_host);
    const u8* body = receiver.body + KZ_HEADER_SIZE;
    const u8 size = static_cast<u8>(receiver.length - KZ_HEADER_SIZE);
    const u8 type = receiver.body[KZ_BODY_TYPE];
    if (to_board && type == KZ_TYPE_targets) {
      kz_targets targets{};
      if (!kz_unpack_targets(&targets, body, size)) continue;
      for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
        if ((targets.mask >> j & 1) == 0) continue;
        board_.target[j] = radians(targets.angle[j]);
        wire_.line_of[j] = line;
      }
    } else if (!to_board && type == KZ_TYPE_read_targets_reply) {
      kz_read_targets_reply reply{};
      if (!kz_unpack_read_targets_reply(&reply, body, size)) continue;
      for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
        if (mine(reply.mask, j)) board_.target[j] = radians(reply.angle[j]);
      }
    } else if (!to_board && type == KZ_TYPE_joints_reply) {
      kz_joints_reply reply{};
      if (!kz_unpack_joints_reply(&reply, body, size)) continue;
      for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
        if (!mine(reply.mask, j)) continue;
        board_.measured[j] = radians(reply.angle[j]);
        if (!has_truth_) board_.duty[j] = reply.duty[j] / 255.0;
      }
      if (line == 0 || reply.status != 0) set_status(time_ns, reply.status);
      measured(time_ns);
    } else if (!to_board && type == KZ_TYPE_statistics_reply) {
      kz_statistics_reply reply{};
      if (line == 0 && kz_unpack_statistics_reply(&reply, body, size))
        board_.worst_tick = 8.0 * reply.worst_8states / KZ_STATES_PER_TICK;
    } else if (!to_board && type == KZ_TYPE_health_reply) {
      kz_health_reply reply{};
      if (line == 0 && kz_unpack_health_reply(&reply, body, size))
        board_.supply_v = reply.supply_mv * 1e-3;
    } else if (!to_board && type == KZ_TYPE_state_reply) {
      kz_state_reply state{};
      if (kz_unpack_state_reply(&state, body, size)) take(state);
    } else if (!to_board && type == KZ_TYPE_telemetry_state) {
      kz_telemetry_state state{};
      if (kz_unpack_telemetry_state(&state, body, size)) take(state);
    }
  }
}

// Of a robot whose trunk nobody knows.
void Feed::poses_of_joints(std::uint64_t time_ns) {
  if (!server_.wanted(channels_.tf)) return;
  data_.clear();
  sim::ros::transforms(data_, time_ns, poses_.at(angle_));
  server_.publish(channels_.tf, time_ns, data_);
}

}  // namespace kaz::viewer
