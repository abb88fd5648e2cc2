// A linked shader program, and functions that set uniforms of the program.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <Eigen/Core>

#include "sim/render/gl/gl_api.h"

namespace kaz::sim {

class GlProgram {
 public:
  // Compiles and links both shaders. `gl` must outlive the program.
  static Result<GlProgram> build(const Gl& gl, const std::string& vertex,
                                 const std::string& fragment);

  void use() const { gl_->UseProgram(id_); }
  // Sets a uniform. Call use() first. If the program has no uniform with this name, the call has no effect.
  void set(const char* name, const Eigen::Matrix4d& value) const;
  void set(const char* name, const Eigen::Vector3d& value) const;
  void set(const char* name, double value) const;
  void set_sampler(const char* name, int unit) const;
  int location(const char* name) const { return gl_->GetUniformLocation(id_, name); }
  void set(int location, const Eigen::Matrix4d& value) const;

 private:
  const Gl* gl_ = nullptr;
  GLuint id_ = 0;
};

}  // namespace kaz::sim
