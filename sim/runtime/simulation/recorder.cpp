// Channels, schemas and messages of the recording.
// SPDX-License-Identifier: Apache-2.0
//
// ROS 1 encoding (fields in order, little-endian, no padding), which viewers decode with the schema text in
// the file.
#include "sim/runtime/simulation/recorder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "sim/runtime/formats/little_endian.h"
#include "sim/runtime/formats/mcap_reader.h"
#include "sim/runtime/time.h"

namespace kaz::sim {
namespace {

constexpr char kWireSchema[] =
    "# Bytes whose stop bit ended in the millisecond before the message's time.\n"
    "uint8[] value\n"
    "uint16[] state  # end of the stop bit: crystal periods since 1 ms before the message's time\n"
    "uint8[] framing_error\n";
constexpr char kPinsSchema[] =
    "# pw and tmo: high counts of the PWM pins, out of 256. p3 to p6: levels of the ports. The\n"
    "# multiplexer select bits of p4 are always 0.\n"
    "uint16[16] pw\nuint16[2] tmo\nuint8 p3\nuint8 p4\nuint8 p5\nuint8 p6\n";
constexpr char kAnalogSchema[] =
    "# A/D codes (0 to 1023) that one firmware tick used. Index: 8 * multiplexer + input.\n"
    "uint32 tick\nuint16[24] code\n";
constexpr char kJointsSchema[] =
    "# True states of the joints, indexed by joint number: angle in rad, torque in Nm, and\n"
    "# temperature of the motor's winding.\n"
    "float64[18] angle\nfloat64[18] torque\nfloat64[18] winding_celsius\n";
constexpr char kPointSchema[] = "# World frame, m.\nfloat64 x\nfloat64 y\nfloat64 z\n";
constexpr char kSupplySchema[] =
    "# Supply voltage at the board (V), and current that the motors draw (A).\n"
    "float64 volts\nfloat64 amperes\n";
constexpr char kContactsSchema[] =
    "# Contacts between shapes in the millisecond before the message's time, every 10 ms.\n"
    "kaz/Contact[] contacts\n"
    "================================================================================\n"
    "MSG: kaz/Contact\n"
    "string a\nstring b\n"
    "float64[3] at     # world frame, m\n"
    "float64[3] force  # force on the shape in field `a`, N\n";
constexpr char kLinkForcesSchema[] =
    "# External contact forces on the robot's links, in the link's axes. Each value is the mean\n"
    "# over the millisecond before the message's time. Contacts between two links of the\n"
    "# robot are not included. Only links in contact are listed.\n"
    "kaz/LinkForce[] links\n"
    "================================================================================\n"
    "MSG: kaz/LinkForce\n"
    "string link\n"
    "float64[3] force   # N\n"
    "float64[3] moment  # Nm, about the link's origin\n"
    "float64[3] centre  # center of pressure, in the link's frame, m\n"
    "float64 pressure   # sum of the normal forces, N\n";
constexpr char kJointLoadsSchema[] =
    "# Force and moment that the parent link exerts on the child link of each joint, in the\n"
    "# millisecond before the message's time, every 10 ms. Each joint has three numbers, in the\n"
    "# order of the joint numbers. The moment is about the joint's origin. Vectors are in the\n"
    "# child's axes. Along the joint's axis, the moment is the torque of motor and stop.\n"
    "float64[54] force   # N\n"
    "float64[54] moment  # Nm\n";
constexpr char kEyesSchema[] =
    "# XXH3-128 digests of the RGB bytes of a stereo pair. The message's time is the exposure.\n"
    "uint64 sequence\n"
    "string left_xxh3\n"
    "string right_xxh3\n";
// As ROS has it, so that viewers show the pictures.
constexpr char kPictureSchema[] =
    "# Rectified picture as the host receives it: 8-bit RGB, lossless. The message's time is the\n"
    "# arrival at the host. The header's stamp is the exposure, and its seq is the pair's number.\n"
    "std_msgs/Header header\nstring format\nuint8[] data\n"
    "================================================================================\n"
    "MSG: std_msgs/Header\n"
    "uint32 seq\ntime stamp\nstring frame_id\n";
// nav_msgs and geometry_msgs as ROS has them, so that viewers draw them.
#define KAZ_ROS_SEPARATOR \
  "================================================================================\n"
#define KAZ_ROS_HEADER     \
  KAZ_ROS_SEPARATOR        \
  "MSG: std_msgs/Header\n" \
  "uint32 seq\ntime stamp\nstring frame_id\n"
#define KAZ_ROS_POSE                                         \
  KAZ_ROS_SEPARATOR                                          \
  "MSG: geometry_msgs/Pose\n"                                \
  "geometry_msgs/Point position\n"                           \
  "geometry_msgs/Quaternion orientation\n" KAZ_ROS_SEPARATOR \
  "MSG: geometry_msgs/Point\n"                               \
  "float64 x\nfloat64 y\nfloat64 z\n" KAZ_ROS_SEPARATOR      \
  "MSG: geometry_msgs/Quaternion\n"                          \
  "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"
constexpr char kMapSchema[] =
    "# Probability of an obstacle, in %; -1: unknown. Row-major order, with x along each row.\n"
    "std_msgs/Header header\nnav_msgs/MapMetaData info\nint8[] data\n" KAZ_ROS_HEADER
        KAZ_ROS_SEPARATOR
    "MSG: nav_msgs/MapMetaData\n"
    "time map_load_time\nfloat32 resolution\nuint32 width\nuint32 height\n"
    "geometry_msgs/Pose origin\n" KAZ_ROS_POSE;
constexpr char kPathSchema[] =
    "# Corners of the path, from start to goal. The list is empty if there is no path.\n"
    "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n" KAZ_ROS_HEADER KAZ_ROS_SEPARATOR
    "MSG: geometry_msgs/PoseStamped\n"
    "std_msgs/Header header\ngeometry_msgs/Pose pose\n" KAZ_ROS_POSE;
constexpr char kPoseSchema[] =
    "# Estimated pose of the robot: the point midway between its feet.\n"
    "std_msgs/Header header\ngeometry_msgs/Pose pose\n" KAZ_ROS_HEADER KAZ_ROS_POSE;
constexpr char kFaultSchema[] =
    "# Fault that begins, as a line of a fault schedule.\nstring line\n";
constexpr char kHandSchema[] =
    "# Manual action. It takes effect in the step that begins at the message's time.\n"
    "string line\n";
constexpr char kBehaviorSchema[] = R"({"type": "object"})";

// The beginning of std_msgs/Header: seq and stamp.
LittleEndian& put_stamp(LittleEndian& to, Time time, std::uint32_t sequence = 0) {
  constexpr std::int64_t second = 1'000'000'000;
  return to.number(sequence)
      .number(static_cast<std::uint32_t>(time.count() / second))
      .number(static_cast<std::uint32_t>(time.count() % second));
}

}  // namespace

Result<std::unique_ptr<Recorder>> Recorder::create(const std::string& path,
                                                   const McapWriter::Metadata& facts,
                                                   MessageTap* tap) {
  auto file = KAZ_TRY(McapWriter::create(path, "kaz", tap));
  file->add_metadata("kaz", facts);
  return std::unique_ptr<Recorder>(new Recorder(std::move(file)));
}

Recorder::Recorder(std::unique_ptr<McapWriter> file) : file_(std::move(file)) {
  const auto numbers = [this](const char* topic, std::uint16_t schema) {
    return file_->add_channel(schema, topic, "ros1");
  };
  wire_bytes_ = file_->add_schema("kaz/WireBytes", "ros1msg", kWireSchema);
  const auto to_board = numbers("/wire/to_board", wire_bytes_);
  lines_.push_back({to_board, numbers("/wire/to_host", wire_bytes_)});
  pins_ = numbers("/board/pins", file_->add_schema("kaz/Pins", "ros1msg", kPinsSchema));
  analog_ = numbers("/board/analog", file_->add_schema("kaz/Analog", "ros1msg", kAnalogSchema));
  joints_ = numbers("/truth/joints", file_->add_schema("kaz/Joints", "ros1msg", kJointsSchema));
  ball_ = numbers("/truth/ball", file_->add_schema("kaz/Point", "ros1msg", kPointSchema));
  supply_ = numbers("/board/supply", file_->add_schema("kaz/Supply", "ros1msg", kSupplySchema));
  contacts_ =
      numbers("/truth/contacts", file_->add_schema("kaz/Contacts", "ros1msg", kContactsSchema));
  link_forces_ = numbers("/truth/link_forces",
                         file_->add_schema("kaz/LinkForces", "ros1msg", kLinkForcesSchema));
  joint_loads_ = numbers("/truth/joint_loads",
                         file_->add_schema("kaz/JointLoads", "ros1msg", kJointLoadsSchema));
  eyes_ = numbers("/eyes", file_->add_schema("kaz/StereoDigest", "ros1msg", kEyesSchema));
  const auto pictures = file_->add_schema("sensor_msgs/CompressedImage", "ros1msg", kPictureSchema);
  left_eye_ = numbers("/eyes/left", pictures);
  right_eye_ = numbers("/eyes/right", pictures);
  behavior_ = file_->add_channel(file_->add_schema("kaz/Behavior", "jsonschema", kBehaviorSchema),
                                 "/behavior", "json");
  faults_ = numbers("/faults", file_->add_schema("kaz/Fault", "ros1msg", kFaultSchema));
}

void Recorder::put(std::uint16_t channel, Time time) {
  file_->add_message(channel, static_cast<std::uint64_t>(time.count()), data_);
}

void Recorder::wire(Direction direction, States step_start, std::span<const SerialByte> bytes,
                    std::size_t line) {
  if (bytes.empty()) return;
  while (lines_.size() <= line) {
    const std::string topic = "/wire/" + std::to_string(lines_.size() + 1);
    const auto to_board = file_->add_channel(wire_bytes_, topic + "/to_board", "ros1");
    lines_.push_back({to_board, file_->add_channel(wire_bytes_, topic + "/to_host", "ros1")});
  }
  data_.clear();
  LittleEndian to(data_);
  const auto count = static_cast<std::uint32_t>(bytes.size());
  to.number(count);
  for (const SerialByte& byte : bytes) to.number(byte.value);
  to.number(count);
  for (const SerialByte& byte : bytes) to.number(static_cast<std::uint16_t>(byte.at - step_start));
  to.number(count);
  for (const SerialByte& byte : bytes) to.number(static_cast<std::uint8_t>(byte.framing_error));
  const Line& channels = lines_[line];
  put(direction == Direction::to_board ? channels.to_board : channels.to_host,
      time_of(step_start + KZ_STATES_PER_TICK));
}

void Recorder::pins(States at, const PinLevels& pins) {
  data_.clear();
  LittleEndian to(data_);
  for (const std::uint16_t counts : pins.pw) to.number(counts);
  for (const std::uint16_t counts : pins.tmo) to.number(counts);
  const auto p4 = static_cast<std::uint8_t>(pins.p4 & ~KZ_P4_MUX_MASK);
  to.number(pins.p3).number(p4).number(pins.p5).number(pins.p6);
  put(pins_, time_of(at));
}

void Recorder::analog(States at, const kz_tick_input& input) {
  data_.clear();
  LittleEndian to(data_);
  to.number(std::uint32_t{input.tick});
  for (const u16 code : input.analog) to.number(std::uint16_t{code});
  put(analog_, time_of(at));
}

void Recorder::joints(States at, std::span<const JointState, KZ_JOINTS> joints) {
  data_.clear();
  std::array<double, 3 * KZ_JOINTS> values{};
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    values[j] = joints[j].angle;
    values[KZ_JOINTS + j] = joints[j].torque;
    values[2 * KZ_JOINTS + j] = joints[j].winding_celsius;
  }
  LittleEndian(data_).reals(values);
  put(joints_, time_of(at));
}

void Recorder::ball(States at, const Eigen::Vector3d& position) {
  data_.clear();
  LittleEndian(data_).real(position.x()).real(position.y()).real(position.z());
  put(ball_, time_of(at));
}

void Recorder::supply(States at, double volts, double amperes) {
  data_.clear();
  LittleEndian(data_).real(volts).real(amperes);
  put(supply_, time_of(at));
}

void Recorder::contacts(States at, std::span<const ContactPoint> points) {
  data_.clear();
  LittleEndian to(data_);
  to.number(static_cast<std::uint32_t>(points.size()));
  for (const ContactPoint& point : points) {
    to.text(point.a).text(point.b);
    to.reals({point.at.data(), 3}).reals({point.force.data(), 3});
  }
  put(contacts_, time_of(at));
}

void Recorder::link_forces(States at, std::span<const std::string> names,
                           std::span<const LinkForce> links) {
  data_.clear();
  LittleEndian to(data_);
  const auto touches = [](const LinkForce& link) { return link.pressure > 0; };
  to.number(static_cast<std::uint32_t>(std::ranges::count_if(links, touches)));
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (!touches(links[i])) continue;
    to.text(names[i]);
    for (const Eigen::Vector3d* v : {&links[i].force, &links[i].moment, &links[i].centre})
      to.reals({v->data(), 3});
    to.real(links[i].pressure);
  }
  put(link_forces_, time_of(at));
}

void Recorder::joint_loads(States at, std::span<const JointLoad, KZ_JOINTS> loads) {
  data_.clear();
  LittleEndian to(data_);
  for (const JointLoad& load : loads) to.reals({load.force.data(), 3});
  for (const JointLoad& load : loads) to.reals({load.moment.data(), 3});
  put(joint_loads_, time_of(at));
}

void Recorder::eyes(const Eyes::Digest& digest) {
  data_.clear();
  LittleEndian(data_).number(digest.sequence).text(digest.kept.left).text(digest.kept.right);
  put(eyes_, digest.exposure);
  picture(false, digest, digest.kept.left_png);
  picture(true, digest, digest.kept.right_png);
}

Recorder::RobotChannels Recorder::robot_channels() {
  if (!robot_) {
    const auto channel = [this](const char* topic, const char* name, const char* text) {
      return file_->add_channel(file_->add_schema(name, "ros1msg", text), topic, "ros1");
    };
    robot_ = {channel("/robot_description", "std_msgs/String", ros::kText),
              channel("/scene", "visualization_msgs/MarkerArray", ros::kMarkers),
              channel("/tf", "tf2_msgs/TFMessage", ros::kTransforms),
              channel("/contacts", "visualization_msgs/MarkerArray", ros::kMarkers)};
  }
  return *robot_;
}

Recorder::MapChannels Recorder::map_channels() {
  if (!maps_) {
    const auto channel = [this](const char* topic, const char* name, const char* text) {
      return file_->add_channel(file_->add_schema(name, "ros1msg", text), topic, "ros1");
    };
    maps_ = {channel("/map", "nav_msgs/OccupancyGrid", kMapSchema),
             channel("/map/path", "nav_msgs/Path", kPathSchema),
             channel("/map/robot", "geometry_msgs/PoseStamped", kPoseSchema)};
  }
  return *maps_;
}

std::uint16_t Recorder::hand_channel() {
  if (!hands_)
    hands_ =
        file_->add_channel(file_->add_schema("kaz/Hand", "ros1msg", kHandSchema), "/hand", "ros1");
  return *hands_;
}

std::array<std::uint16_t, 2> Recorder::camera_channels() {
  if (!camera_infos_) {
    const auto schema = file_->add_schema("sensor_msgs/CameraInfo", "ros1msg", ros::kCameraInfo);
    camera_infos_ = {file_->add_channel(schema, "/eyes/left/camera_info", "ros1"),
                     file_->add_channel(schema, "/eyes/right/camera_info", "ros1")};
  }
  return *camera_infos_;
}

void Recorder::add_all_channels() {
  robot_channels();
  map_channels();
  camera_channels();
  hand_channel();
}

void Recorder::description(States at, std::string_view urdf) {
  data_.clear();
  LittleEndian(data_).text(urdf);
  put(robot_channels().description, time_of(at));
}

void Recorder::scene(States at, const Scene& scene, std::span<const std::string> robot_frames) {
  data_.clear();
  ros::markers(data_, static_cast<std::uint64_t>(time_of(at).count()),
               ros::markers_of(scene, robot_frames));
  put(robot_channels().scene, time_of(at));
}

void Recorder::transforms(States at, std::span<const ros::NamedPose> poses) {
  data_.clear();
  ros::transforms(data_, static_cast<std::uint64_t>(time_of(at).count()), poses);
  put(robot_channels().transforms, time_of(at));
}

void Recorder::contact_markers(States at, std::span<const ContactPoint> points) {
  data_.clear();
  ros::markers(data_, static_cast<std::uint64_t>(time_of(at).count()), ros::markers_of(points));
  put(robot_channels().contacts, time_of(at));
}

void Recorder::picture(bool right, const Eyes::Digest& digest, std::span<const std::uint8_t> png) {
  if (png.empty()) return;
  if (camera_) {
    data_.clear();
    ros::camera_info(data_, static_cast<std::uint64_t>(digest.exposure.count()), *camera_, right);
    put(camera_channels()[right ? 1 : 0], digest.arrival);
  }
  data_.clear();
  LittleEndian to(data_);
  put_stamp(to, digest.exposure, static_cast<std::uint32_t>(digest.sequence))
      .text(right ? "right_eye" : "left_eye")
      .text("png")
      .number(static_cast<std::uint32_t>(png.size()))
      .bytes(png);
  put(right ? right_eye_ : left_eye_, digest.arrival);
}

void Recorder::behavior(States at, std::string_view json) {
  data_.assign(json.begin(), json.end());
  put(behavior_, time_of(at));
}

void Recorder::map(States at, const RecordedMap& map) {
  const MapChannels channels = map_channels();
  LittleEndian to(data_);
  const auto header = [&] { put_stamp(to, time_of(at)).text("map"); };
  const auto pose = [&](const Eigen::Vector2d& place, double heading_rad) {
    to.reals(std::array{place.x(), place.y(), 0.0});
    to.reals(std::array{0.0, 0.0, std::sin(heading_rad / 2), std::cos(heading_rad / 2)});
  };

  data_.clear();
  header();
  to.number(std::uint32_t{0}).number(std::uint32_t{0});  // map_load_time
  to.number(std::bit_cast<std::uint32_t>(static_cast<float>(map.cell_m)));
  to.number(static_cast<std::uint32_t>(map.cells_x));
  to.number(static_cast<std::uint32_t>(map.cells_y));
  pose(map.corner, 0);
  to.number(static_cast<std::uint32_t>(map.cells.size()));
  for (const std::int8_t cell : map.cells) to.number(static_cast<std::uint8_t>(cell));
  put(channels.map, time_of(at));

  data_.clear();
  header();
  to.number(static_cast<std::uint32_t>(map.path.size()));
  double heading_rad = 0;  // the last corner has that of the leg that ends there
  for (std::size_t i = 0; i < map.path.size(); ++i) {
    if (i + 1 < map.path.size()) {
      const Eigen::Vector2d leg = map.path[i + 1] - map.path[i];
      heading_rad = std::atan2(leg.y(), leg.x());
    }
    header();
    pose(map.path[i], heading_rad);
  }
  put(channels.path, time_of(at));

  data_.clear();
  header();
  pose(map.robot, map.heading_rad);
  put(channels.robot, time_of(at));
}

void Recorder::hand(States at, std::string_view line) {
  data_.clear();
  LittleEndian(data_).text(std::string(line));
  put(hand_channel(), time_of(at));
}

void Recorder::fault(States at, std::string_view line) {
  data_.clear();
  LittleEndian(data_).text(std::string(line));
  put(faults_, time_of(at));
}

void Recorder::interrupted(const std::string& by) {
  file_->add_metadata("end", {{McapRecording::kInterrupted, by}});
}

}  // namespace kaz::sim
