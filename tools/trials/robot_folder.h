// A temporary folder with modified copies of a robot's files. A RobotFolder owns its folder and removes it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <utility>

#include "shared/base/result.hpp"

namespace kaz::trials {

// Formats a number with nine significant digits.
std::string digits(double value);
// Replaces each number between the text `before` and the next quotation mark by change(number).
std::string with_numbers(const std::string& text, const std::string& before,
                         const std::function<double(double)>& change);
// Multiplies the mass and the inertia tensor of each <inertial> of a URDF by factor(n). The number n counts
// the <inertial> elements in the order of the file, from 0.
std::string with_masses(const std::string& urdf,
                        const std::function<double(std::uint64_t)>& factor);

class RobotFolder {
 public:
  using Change = std::function<std::string(const std::string&)>;
  // Copies kaz.urdf, motor.xml, camera.json and sensors.xml from the folder `robot`. Changes each file with
  // the function that `changes` contains for the file's name. Writes `world` to world.sdf. Fails if a file
  // cannot be read or written.
  static Result<RobotFolder> make(const std::string& robot,
                                  const std::map<std::string, Change>& changes,
                                  const std::string& world);
  RobotFolder(RobotFolder&& other) noexcept : folder_(std::exchange(other.folder_, {})) {}
  RobotFolder& operator=(RobotFolder&&) = delete;
  ~RobotFolder();

  std::string world() const { return folder_ / "world.sdf"; }
  std::string robot() const { return folder_ / "kaz.urdf"; }
  std::string camera() const { return folder_ / "camera.json"; }
  std::filesystem::path folder() const { return folder_; }
  // Calls `keep` with the name and the contents of each file, to make permanent copies. Fails if a file
  // cannot be read or `keep` returns an error.
  using Keep = std::function<Result<void>(const std::string& name, const std::string& contents)>;
  Result<void> each(const Keep& keep) const;

 private:
  explicit RobotFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}
  std::filesystem::path folder_;
};

}  // namespace kaz::trials
