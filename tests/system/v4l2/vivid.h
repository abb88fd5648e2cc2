// For tests: sets controls of the kernel's virtual video driver by name.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kaz::tests {

// A second handle on a device, as in another program. Throws std::runtime_error if the device cannot be
// opened, or the driver has no such control or rejects the value.
class Vivid {
 public:
  explicit Vivid(const std::string& path);
  ~Vivid();
  Vivid(const Vivid&) = delete;
  Vivid& operator=(const Vivid&) = delete;

  void set(const std::string& control, int value);                    // buttons too
  void choose(const std::string& control, const std::string& entry);  // entry of a menu
  void reserve_buffers();                                             // makes the device busy

 private:
  int descriptor_;
};

}  // namespace kaz::tests
