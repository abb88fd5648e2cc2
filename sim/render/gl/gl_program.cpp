// Compiles and links shading programs.
// SPDX-License-Identifier: Apache-2.0
#include "sim/render/gl/gl_program.h"

#include <array>

namespace kaz::sim {

Result<GlProgram> GlProgram::build(const Gl& gl, const std::string& vertex,
                                   const std::string& fragment) {
  GlProgram program;
  program.gl_ = &gl;
  program.id_ = gl.CreateProgram();
  const std::array<std::pair<GLenum, const std::string*>, 2> stages = {
      {{GL_VERTEX_SHADER, &vertex}, {GL_FRAGMENT_SHADER, &fragment}}};
  for (const auto& [stage, source] : stages) {
    const GLuint shader = gl.CreateShader(stage);
    const char* text = source->c_str();
    gl.ShaderSource(shader, 1, &text, nullptr);
    gl.CompileShader(shader);
    gl.AttachShader(program.id_, shader);
    gl.DeleteShader(shader);  // the program keeps it
  }
  gl.LinkProgram(program.id_);
  GLint linked = GL_FALSE;
  gl.GetProgramiv(program.id_, GL_LINK_STATUS, &linked);
  if (linked == GL_FALSE) {
    std::array<char, 512> log{};
    gl.GetProgramInfoLog(program.id_, static_cast<GLsizei>(log.size()), nullptr, log.data());
    return fail(Fault::environment, std::string("this OpenGL rejects a shader of the renderer (") +
                                        log.data() + "): install Mesa 22.3 or newer");
  }
  return program;
}

void GlProgram::set(int location, const Eigen::Matrix4d& value) const {
  const Eigen::Matrix4f floats = value.cast<float>();
  gl_->UniformMatrix4fv(location, 1, GL_FALSE, floats.data());
}

void GlProgram::set(const char* name, const Eigen::Matrix4d& value) const {
  set(location(name), value);
}

void GlProgram::set(const char* name, const Eigen::Vector3d& value) const {
  const Eigen::Vector3f floats = value.cast<float>();
  gl_->Uniform3f(location(name), floats.x(), floats.y(), floats.z());
}

void GlProgram::set(const char* name, double value) const {
  gl_->Uniform1f(location(name), static_cast<float>(value));
}

void GlProgram::set_sampler(const char* name, int unit) const {
  gl_->Uniform1i(location(name), unit);
}

}  // namespace kaz::sim
