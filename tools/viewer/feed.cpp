// What viewers get beside the recorded channels.
// SPDX-License-Identifier: Apache-2.0
#include "tools/viewer/feed.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "shared/base/files.hpp"
#include "shared/base/number_text.hpp"
#include "shared/picture/jpeg.h"
#include "shared/protocol/message_info.h"
#include "shared/protocol/messages.h"
#include "sim/board/servo_board.h"
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

#define KAZ_2D                                                           \
  KAZ_ROS_MSG "foxglove_msgs/Point2\nfloat64 x\nfloat64 y\n" KAZ_ROS_MSG \
              "foxglove_msgs/Color\nfloat64 r\nfloat64 g\nfloat64 b\nfloat64 a\n"
constexpr char kAnnotations[] =
    "foxglove_msgs/CircleAnnotation[] circles\nfoxglove_msgs/PointsAnnotation[] points\n"
    "foxglove_msgs/TextAnnotation[] texts\n" KAZ_ROS_MSG
    "foxglove_msgs/CircleAnnotation\ntime timestamp\nfoxglove_msgs/Point2 position\n"
    "float64 diameter\nfloat64 thickness\nfoxglove_msgs/Color fill_color\n"
    "foxglove_msgs/Color outline_color\n" KAZ_ROS_MSG
    "foxglove_msgs/PointsAnnotation\nuint8 UNKNOWN=0\nuint8 POINTS=1\nuint8 LINE_LOOP=2\n"
    "uint8 LINE_STRIP=3\nuint8 LINE_LIST=4\ntime timestamp\nuint8 type\n"
    "foxglove_msgs/Point2[] points\nfoxglove_msgs/Color outline_color\n"
    "foxglove_msgs/Color[] outline_colors\nfoxglove_msgs/Color fill_color\n"
    "float64 thickness\n" KAZ_ROS_MSG
    "foxglove_msgs/TextAnnotation\ntime timestamp\nfoxglove_msgs/Point2 position\nstring text\n"
    "float64 font_size\nfoxglove_msgs/Color text_color\n"
    "foxglove_msgs/Color background_color\n" KAZ_2D;

constexpr std::string_view kWire = "/wire/";
constexpr std::uint64_t kSecond = 1'000'000'000;

std::uint64_t time_of(const vision::FrameInfo& info) {
  return static_cast<std::uint64_t>(std::max<std::int64_t>(0, info.exposure.count()));
}

}  // namespace

Result<Feed> Feed::create(Server& server, const std::string& robot_path,
                          const FeedOptions& options) {
  auto model = KAZ_TRY(sim::load_robot(robot_path));
  Feed feed(server, std::move(model), options);
  if (options.recorded_robot) return feed;
  const std::string urdf = KAZ_TRY(read_whole_file(robot_path, 16 << 20));
  LittleEndian(feed.data_).text(urdf);
  server.publish(feed.channels_.description, 0, feed.data_, {.kept = true});
  return feed;
}

Feed::Feed(Server& server, sim::RobotModel model, const FeedOptions& options)
    : server_(server),
      model_(std::move(model)),
      period_ns_(static_cast<std::uint64_t>(1e9 / options.rate_hz)),
      hangs_(options.hangs),
      posed_(options.recorded_robot) {
  const auto add = [&server](const char* topic, const char* name, const char* schema,
                             bool derived = true) {
    return server.add_channel({0, topic, "ros1", name, "ros1msg", schema}, derived);
  };
  // The recording has these of a simulated robot.
  const bool derived = !options.recorded_robot;
  channels_.tf = add("/tf", "tf2_msgs/TFMessage", sim::ros::kTransforms, derived);
  channels_.joint_states = add("/joint_states", "sensor_msgs/JointState", kJointState);
  channels_.description = add("/robot_description", "std_msgs/String", sim::ros::kText, derived);
  add("/scene", "visualization_msgs/MarkerArray", sim::ros::kMarkers, derived);
  add("/contacts", "visualization_msgs/MarkerArray", sim::ros::kMarkers, derived);
  channels_.board = add("/board/state", "kaz/BoardState", kBoard);
  channels_.left = add("/eyes/left", "sensor_msgs/CompressedImage", sim::ros::kPicture);
  channels_.right = add("/eyes/right", "sensor_msgs/CompressedImage", sim::ros::kPicture);
  channels_.annotations =
      add("/eyes/left/annotations", "foxglove_msgs/ImageAnnotations", kAnnotations);
  channels_.left_info =
      add("/eyes/left/camera_info", "sensor_msgs/CameraInfo", sim::ros::kCameraInfo);
  channels_.right_info =
      add("/eyes/right/camera_info", "sensor_msgs/CameraInfo", sim::ros::kCameraInfo);
  restart();
}

void Feed::restart() {
  next_ns_.reset();
  lines_.clear();
  frames_to_board_ = frames_to_host_ = frames_damaged_ = 0;
  worst_tick_ = 0;
}

bool Feed::due(std::uint64_t time_ns) {
  if (next_ns_ && time_ns < *next_ns_) return false;
  next_ns_ = time_ns - time_ns % period_ns_ + period_ns_;
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
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) duty_[j] = sim::duty_of(pins, j);
}

void Feed::joints(std::uint64_t time_ns, std::span<const std::uint8_t> data) {
  if (!due(time_ns)) return;
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
  if (has_truth_ || !due(time_ns)) return;
  server_.publish_time(time_ns);
  joint_states(time_ns, measured_, {});
  board_state(time_ns);
  angle_ = measured_;
  poses_of_joints(time_ns);
}

// Without `torques` none are stated.
void Feed::joint_states(std::uint64_t time_ns, std::span<const double> angles,
                        std::span<const double> torques) {
  if (!server_.wanted(channels_.joint_states)) return;
  data_.clear();
  LittleEndian to(data_);
  const std::size_t count = std::min<std::size_t>(KZ_JOINTS, model_.joints.size());
  const auto size = static_cast<std::uint32_t>(count);
  header(to, time_ns, "").number(size);
  for (std::size_t j = 0; j < count; ++j) to.text(model_.joints[j].name);
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
    to.text(j < model_.joints.size() ? model_.joints[j].name : std::string());
  to.reals(target_).reals(measured_).reals(duty_);
  const auto reason = static_cast<u8>(status_ >> 8);
  to.number(status_).text(reason == 0 ? "" : kz_shutdown_text(reason)).real(supply_v_);
  to.real(worst_tick_).number(frames_to_board_).number(frames_to_host_).number(frames_damaged_);
  server_.publish(channels_.board, time_ns, data_);
}

// A shutdown is published at once: the run may end by it.
void Feed::set_status(std::uint64_t time_ns, std::uint16_t status) {
  const bool other_reason = status >> 8 != status_ >> 8;
  status_ = status;
  if (other_reason) board_state(time_ns);
}

void Feed::wire(std::uint64_t time_ns, std::size_t line, bool to_board,
                std::span<const std::uint8_t> data) {
  LittleEndianFields fields(data);
  const auto values = fields.array();
  while (lines_.size() <= line) {
    for (kz_receiver& receiver : lines_.emplace_back().receivers) kz_receiver_init(&receiver);
  }
  kz_receiver& receiver = lines_[line].receivers[to_board ? 0 : 1];
  const auto radians = [](s16 angle) {
    return static_cast<double>(angle) / static_cast<double>(KZ_ANGLE_PER_RAD);
  };
  const auto take = [&](const auto& state) {
    for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
      if (line_of_[j] == line) measured_[j] = radians(state.angle[j]);
    }
    if (line == 0 || state.status != 0) set_status(time_ns, state.status);
    if (line == 0) supply_v_ = state.supply_mv * 1e-3;
    measured(time_ns);
  };
  const auto mine = [&](std::uint32_t mask, std::size_t j) {
    return (mask >> j & 1) != 0 && line_of_[j] == line;
  };
  for (const std::uint8_t value : values) {
    const u8 result = kz_receive(&receiver, value, 0);
    // Below KZ_RECEIVE_BAD_CHECK there is nothing yet, or a frame.
    if (result >= KZ_RECEIVE_BAD_CHECK) ++frames_damaged_;
    if (result != KZ_RECEIVE_FRAME || receiver.length < KZ_HEADER_SIZE) continue;
    ++(to_board ? frames_to_board_ : frames_to_host_);
    const u8* body = receiver.body + KZ_HEADER_SIZE;
    const u8 size = static_cast<u8>(receiver.length - KZ_HEADER_SIZE);
    const u8 type = receiver.body[KZ_BODY_TYPE];
    if (to_board && type == KZ_TYPE_targets) {
      kz_targets targets{};
      if (!kz_unpack_targets(&targets, body, size)) continue;
      for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
        if ((targets.mask >> j & 1) == 0) continue;
        target_[j] = radians(targets.angle[j]);
        line_of_[j] = line;
      }
    } else if (!to_board && type == KZ_TYPE_read_targets_reply) {
      kz_read_targets_reply reply{};
      if (!kz_unpack_read_targets_reply(&reply, body, size)) continue;
      for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
        if (mine(reply.mask, j)) target_[j] = radians(reply.angle[j]);
      }
    } else if (!to_board && type == KZ_TYPE_joints_reply) {
      kz_joints_reply reply{};
      if (!kz_unpack_joints_reply(&reply, body, size)) continue;
      for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
        if (!mine(reply.mask, j)) continue;
        measured_[j] = radians(reply.angle[j]);
        if (!has_truth_) duty_[j] = reply.duty[j] / 255.0;
      }
      if (line == 0 || reply.status != 0) set_status(time_ns, reply.status);
      measured(time_ns);
    } else if (!to_board && type == KZ_TYPE_statistics_reply) {
      kz_statistics_reply reply{};
      if (line == 0 && kz_unpack_statistics_reply(&reply, body, size))
        worst_tick_ = 8.0 * reply.worst_8states / KZ_STATES_PER_TICK;
    } else if (!to_board && type == KZ_TYPE_health_reply) {
      kz_health_reply reply{};
      if (line == 0 && kz_unpack_health_reply(&reply, body, size))
        supply_v_ = reply.supply_mv * 1e-3;
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
  std::vector<Eigen::Isometry3d> links(model_.links.size(), Eigen::Isometry3d::Identity());
  for (std::size_t i = 1; i < links.size(); ++i) {
    const sim::RobotLink& link = model_.links[i];
    const auto parent = static_cast<std::size_t>(link.parent);
    links[i] = links[parent] * model_.links[parent].at_zero.inverse() * link.at_zero;
    if (link.joint < 0 || link.joint >= KZ_JOINTS) continue;
    const auto j = static_cast<std::size_t>(link.joint);
    const Eigen::Vector3d axis = link.at_zero.linear().transpose() * model_.joints[j].axis;
    links[i].rotate(Eigen::AngleAxisd(angle_[j], axis));
  }
  if (!hangs_) {
    const Eigen::Isometry3d root = standing(links);
    for (Eigen::Isometry3d& link : links) link = root * link;
  }
  std::vector<sim::ros::NamedPose> poses;
  for (const auto& [name, frame] : model_.frames)
    poses.emplace_back(name, links[static_cast<std::size_t>(frame.link)] * frame.in_link);
  data_.clear();
  sim::ros::transforms(data_, time_ns, poses);
  server_.publish(channels_.tf, time_ns, data_);
}

// Pose of the root, of which `links` are given, in which the lowest of the links that end a chain is level,
// as it is at the zero posture, and the robot's lowest point is on the floor.
Eigen::Isometry3d Feed::standing(const std::vector<Eigen::Isometry3d>& links) const {
  if (model_.fixed_base || links.empty()) return Eigen::Isometry3d::Identity();
  const auto bottom = [&](std::size_t i, const Eigen::Matrix3d& turn) {
    double lowest = std::numeric_limits<double>::infinity();
    for (const sim::CollisionShape& shape : model_.links[i].rigid.collisions) {
      const Eigen::Isometry3d at = Eigen::Isometry3d(turn) * links[i] * shape.in_link;
      lowest = std::min(lowest, sim::extent(shape.shape, at).min().z());
    }
    return lowest;
  };
  std::vector<bool> carries(links.size(), false);
  for (const sim::RobotLink& link : model_.links) {
    if (link.parent >= 0) carries[static_cast<std::size_t>(link.parent)] = true;
  }
  std::size_t foot = 0;
  double lowest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < links.size(); ++i) {
    const double at = carries[i] ? lowest : bottom(i, Eigen::Matrix3d::Identity());
    if (at < lowest) {
      lowest = at;
      foot = i;
    }
  }
  Eigen::Isometry3d root = Eigen::Isometry3d::Identity();
  root.linear() = model_.links[foot].at_zero.linear() * links[foot].linear().transpose();
  double height = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < links.size(); ++i)
    height = std::min(height, bottom(i, root.linear()));
  if (std::isfinite(height)) root.translation().z() = -height;
  return root;
}

void Feed::camera(std::uint64_t time_ns, const vision::CameraModel& model,
                  std::vector<std::uint8_t>& data) {
  for (const bool right : {false, true}) {
    const auto channel = right ? channels_.right_info : channels_.left_info;
    if (!server_.wanted(channel)) continue;
    data.clear();
    sim::ros::camera_info(data, time_ns, model, right);
    server_.publish(channel, time_ns, data);
  }
}

bool Feed::wants_pictures() const {
  return server_.wanted(channels_.left) || server_.wanted(channels_.right);
}

void Feed::pictures(const vision::StereoPair& pair, bool pixels) {
  const auto time_ns = time_of(pair.info);
  // Earlier than the last by more than that: another run.
  if (time_ns < next_picture_ns_ && time_ns + kSecond > next_picture_ns_) return;
  // Half of the eyes' pictures: coding them takes most of what a viewer costs.
  next_picture_ns_ = time_ns + kSecond / 16;
  std::vector<std::uint8_t> data;
  camera(time_ns, pair.info.camera, data);
  const bool left = server_.wanted(channels_.left), right = server_.wanted(channels_.right);
  if (!pixels || (!left && !right)) return;
  const auto images = pair.images.get();
  if (!images) return;
  if (left) jpeg(channels_.left, pair.info, images->left, "left_eye");
  if (right) jpeg(channels_.right, pair.info, images->right, "right_eye");
}

void Feed::jpeg(std::uint32_t channel, const vision::FrameInfo& info, const vision::Image& image,
                std::string_view frame) {
  const auto coded =
      picture::encode_jpeg({image.width, image.height, 3, 8, image.rgb}, {80, false});
  if (!coded) return;
  const auto time_ns = time_of(info);
  std::vector<std::uint8_t> data;
  LittleEndian to(data);
  header(to, time_ns, frame, static_cast<std::uint32_t>(info.sequence))
      .text("jpeg")
      .number(static_cast<std::uint32_t>(coded->size()))
      .bytes(*coded);
  server_.publish(channel, time_ns, data);
}

std::uint32_t Feed::add_pictures(const std::string& topic) {
  return server_.add_channel(
      {0, topic, "ros1", "sensor_msgs/CompressedImage", "ros1msg", sim::ros::kPicture}, true);
}

bool Feed::wants_picture(std::uint32_t channel, const vision::FrameInfo& info) {
  if (!server_.wanted(channel)) return false;
  const auto time_ns = time_of(info);
  std::uint64_t& next = next_made_ns_[channel];
  if (time_ns < next && time_ns + kSecond > next) return false;
  next = time_ns + kSecond / 8;
  return true;
}

void Feed::picture(std::uint32_t channel, const vision::FrameInfo& info,
                   const vision::Image& image) {
  jpeg(channel, info, image, "left_eye");
}

void Feed::ball(const vision::FrameInfo& info, const vision::BallObservation& ball) {
  if (!server_.wanted(channels_.annotations)) return;
  const auto time_ns = time_of(info);
  std::vector<std::uint8_t> data;
  LittleEndian to(data);
  const auto stamp = [&] {
    to.number(static_cast<std::uint32_t>(time_ns / kSecond))
        .number(static_cast<std::uint32_t>(time_ns % kSecond));
  };
  constexpr std::array kYellow{0.94, 0.89, 0.26, 1.0}, kNone{0.0, 0.0, 0.0, 0.0};
  to.number(std::uint32_t{ball.found ? 1u : 0u});
  if (ball.found) {
    stamp();
    to.real(ball.center_u).real(ball.center_v).real(2 * ball.radius_px).real(2);
    to.reals(kNone).reals(kYellow);
  }
  to.number(std::uint32_t{0});
  to.number(std::uint32_t{ball.found ? 1u : 0u});
  if (ball.found) {
    char text[48];
    std::snprintf(text, sizeof text, "%.2f m", ball.distance_m);
    stamp();
    to.real(ball.center_u + ball.radius_px + 3).real(ball.center_v).text(text).real(12);
    to.reals(kYellow).reals(kNone);
  }
  server_.publish(channels_.annotations, time_ns, data);
}

}  // namespace kaz::viewer
