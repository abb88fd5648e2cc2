// VIDIOC_QUERYCTRL over all controls.
// SPDX-License-Identifier: Apache-2.0
#include "tests/system/v4l2/vivid.h"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace kaz::tests {
namespace {

v4l2_queryctrl find(int descriptor, const std::string& name) {
  v4l2_queryctrl query{};
  query.id = V4L2_CTRL_FLAG_NEXT_CTRL;
  std::string all;
  while (ioctl(descriptor, VIDIOC_QUERYCTRL, &query) == 0) {
    const char* text = reinterpret_cast<const char*>(query.name);
    if (name == text) return query;
    all += std::string(", ") + text;
    query.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
  }
  throw std::runtime_error("no control '" + name + "'" + all);
}

}  // namespace

Vivid::Vivid(const std::string& path) : descriptor_(open(path.c_str(), O_RDWR | O_CLOEXEC)) {
  if (descriptor_ < 0) throw std::runtime_error(path + ": " + std::strerror(errno));
}

Vivid::~Vivid() {
  close(descriptor_);
}

void Vivid::set(const std::string& control, int value) {
  v4l2_control setting{find(descriptor_, control).id, value};
  if (ioctl(descriptor_, VIDIOC_S_CTRL, &setting) != 0)
    throw std::runtime_error(control + ": " + std::strerror(errno));
}

void Vivid::choose(const std::string& control, const std::string& entry) {
  const v4l2_queryctrl query = find(descriptor_, control);
  std::string all;
  for (int i = query.minimum; i <= query.maximum; ++i) {
    v4l2_querymenu menu{};
    menu.id = query.id;
    menu.index = static_cast<__u32>(i);
    if (ioctl(descriptor_, VIDIOC_QUERYMENU, &menu) != 0) continue;
    const char* text = reinterpret_cast<const char*>(menu.name);
    if (entry == text) return set(control, i);
    all += std::string(", ") + text;
  }
  throw std::runtime_error(control + " has no '" + entry + "'" + all);
}

void Vivid::reserve_buffers() {
  v4l2_requestbuffers request{};
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  request.memory = V4L2_MEMORY_MMAP;
  request.count = 2;
  if (ioctl(descriptor_, VIDIOC_REQBUFS, &request) != 0)
    throw std::runtime_error(std::string("no buffers: ") + std::strerror(errno));
}

}  // namespace kaz::tests
