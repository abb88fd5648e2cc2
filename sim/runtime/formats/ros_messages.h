// Schemas and serialization of ROS 1 messages. Viewers decode and draw these messages.
// SPDX-License-Identifier: Apache-2.0
//
// Encoding: fields in order, little-endian, without padding. Units: m, rad, s. Frames: `world`, and the names
// of links and objects.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "sim/body/description/scene.h"
#include "sim/body/world/world.h"
#include "sim/runtime/formats/little_endian.h"
#include "vision/image/frame.h"

namespace kaz::sim::ros {

#define KAZ_ROS_MSG                                                                    \
  "================================================================================\n" \
  "MSG: "
#define KAZ_ROS_STD_HEADER KAZ_ROS_MSG "std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n"
#define KAZ_ROS_VECTOR KAZ_ROS_MSG "geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n"
#define KAZ_ROS_QUATERNION \
  KAZ_ROS_MSG "geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"
#define KAZ_ROS_POINT KAZ_ROS_MSG "geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n"

inline constexpr char kTransforms[] =
    "geometry_msgs/TransformStamped[] transforms\n" KAZ_ROS_MSG
    "geometry_msgs/TransformStamped\nstd_msgs/Header header\nstring child_frame_id\n"
    "geometry_msgs/Transform transform\n" KAZ_ROS_STD_HEADER KAZ_ROS_MSG
    "geometry_msgs/Transform\ngeometry_msgs/Vector3 translation\n"
    "geometry_msgs/Quaternion rotation\n" KAZ_ROS_VECTOR KAZ_ROS_QUATERNION;
inline constexpr char kText[] = "string data\n";
inline constexpr char kMarkers[] =
    "visualization_msgs/Marker[] markers\n" KAZ_ROS_MSG
    "visualization_msgs/Marker\nuint8 ARROW=0\nuint8 CUBE=1\nuint8 SPHERE=2\nuint8 CYLINDER=3\n"
    "uint8 ADD=0\nuint8 DELETEALL=3\nstd_msgs/Header header\nstring ns\nint32 id\nint32 type\n"
    "int32 action\ngeometry_msgs/Pose pose\ngeometry_msgs/Vector3 scale\nstd_msgs/ColorRGBA color\n"
    "duration lifetime\nbool frame_locked\ngeometry_msgs/Point[] points\n"
    "std_msgs/ColorRGBA[] colors\nstring text\nstring mesh_resource\n"
    "bool mesh_use_embedded_materials\n" KAZ_ROS_STD_HEADER KAZ_ROS_MSG
    "geometry_msgs/Pose\ngeometry_msgs/Point position\n"
    "geometry_msgs/Quaternion orientation\n" KAZ_ROS_POINT KAZ_ROS_QUATERNION KAZ_ROS_VECTOR
        KAZ_ROS_MSG "std_msgs/ColorRGBA\nfloat32 r\nfloat32 g\nfloat32 b\nfloat32 a\n";
inline constexpr char kCameraInfo[] =
    "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] D\n"
    "float64[9] K\nfloat64[9] R\nfloat64[12] P\nuint32 binning_x\nuint32 binning_y\n"
    "sensor_msgs/RegionOfInterest roi\n" KAZ_ROS_STD_HEADER KAZ_ROS_MSG
    "sensor_msgs/RegionOfInterest\nuint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\n"
    "bool do_rectify\n";
inline constexpr char kPicture[] =
    "std_msgs/Header header\nstring format\nuint8[] data\n" KAZ_ROS_STD_HEADER;

// Writes std_msgs/Header, the first field of most messages.
LittleEndian& header(LittleEndian& to, std::uint64_t time_ns, std::string_view frame,
                     std::uint32_t sequence = 0);
// Writes geometry_msgs/Pose or Transform.
void pose(LittleEndian& to, const Eigen::Isometry3d& at);

using NamedPose = std::pair<std::string, Eigen::Isometry3d>;  // pose in the frame `world`

// Writes tf2_msgs/TFMessage to `data`. If a function in this file has the parameter `data`, `data` must be
// empty before the call.
void transforms(std::vector<std::uint8_t>& data, std::uint64_t time_ns,
                std::span<const NamedPose> poses);

struct Marker {
  enum Type { arrow = 0, cube = 1, sphere = 2, cylinder = 3 };
  std::string frame = "world", space;
  std::uint32_t id = 0;
  Type type = cube;
  Eigen::Isometry3d at = Eigen::Isometry3d::Identity();
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
  Rgb color = {};
  // Name of the texture (Visual::texture). The name is written to the message field `text`. ROS uses the
  // field `text` only for text markers. Kaz creates no text markers, so the field `text` can contain the name
  // of the texture.
  std::string texture;
  bool removes_all = false;
};

// Writes visualization_msgs/MarkerArray.
void markers(std::vector<std::uint8_t>& data, std::uint64_t time_ns,
             std::span<const Marker> markers);

// Returns markers for the visuals of the scene. Meshes get no markers. If a frame is in the list `without`,
// the visuals of this frame get no markers.
std::vector<Marker> markers_of(const Scene& scene, std::span<const std::string> without);

// Returns contact forces above 0.05 N as arrows of 1 cm/N, at most 30 cm long. Each arrow has the direction
// of the force on the body ContactPoint::a. The first marker removes the arrows of the previous message.
std::vector<Marker> markers_of(std::span<const ContactPoint> contacts);

// Writes sensor_msgs/CameraInfo of one camera of a rectified pair.
void camera_info(std::vector<std::uint8_t>& data, std::uint64_t time_ns,
                 const vision::CameraModel& model, bool right);

}  // namespace kaz::sim::ros
