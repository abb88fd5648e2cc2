// OpenGL functions. The functions are looked up at run time, so the program needs no OpenGL library at link
// time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <GL/glcorearb.h>

#include "shared/base/result.hpp"
#include "sim/render/gl/gl_context.h"

namespace kaz::sim {

#define KAZ_GL_FUNCTIONS(X)                           \
  X(ACTIVETEXTURE, ActiveTexture)                     \
  X(ATTACHSHADER, AttachShader)                       \
  X(BINDBUFFER, BindBuffer)                           \
  X(BINDFRAMEBUFFER, BindFramebuffer)                 \
  X(BINDRENDERBUFFER, BindRenderbuffer)               \
  X(BINDTEXTURE, BindTexture)                         \
  X(BINDVERTEXARRAY, BindVertexArray)                 \
  X(BUFFERDATA, BufferData)                           \
  X(CHECKFRAMEBUFFERSTATUS, CheckFramebufferStatus)   \
  X(CLEAR, Clear)                                     \
  X(COMPILESHADER, CompileShader)                     \
  X(CREATEPROGRAM, CreateProgram)                     \
  X(CREATESHADER, CreateShader)                       \
  X(CULLFACE, CullFace)                               \
  X(DELETEFRAMEBUFFERS, DeleteFramebuffers)           \
  X(DELETERENDERBUFFERS, DeleteRenderbuffers)         \
  X(DELETESHADER, DeleteShader)                       \
  X(DEPTHFUNC, DepthFunc)                             \
  X(DRAWARRAYS, DrawArrays)                           \
  X(DRAWBUFFER, DrawBuffer)                           \
  X(DRAWELEMENTS, DrawElements)                       \
  X(ENABLE, Enable)                                   \
  X(DISABLE, Disable)                                 \
  X(ENABLEVERTEXATTRIBARRAY, EnableVertexAttribArray) \
  X(FRAMEBUFFERRENDERBUFFER, FramebufferRenderbuffer) \
  X(FRAMEBUFFERTEXTURE2D, FramebufferTexture2D)       \
  X(FRONTFACE, FrontFace)                             \
  X(GENBUFFERS, GenBuffers)                           \
  X(GENFRAMEBUFFERS, GenFramebuffers)                 \
  X(GENRENDERBUFFERS, GenRenderbuffers)               \
  X(GENTEXTURES, GenTextures)                         \
  X(GENVERTEXARRAYS, GenVertexArrays)                 \
  X(GETERROR, GetError)                               \
  X(GETPROGRAMINFOLOG, GetProgramInfoLog)             \
  X(GETPROGRAMIV, GetProgramiv)                       \
  X(GETUNIFORMLOCATION, GetUniformLocation)           \
  X(LINKPROGRAM, LinkProgram)                         \
  X(PIXELSTOREI, PixelStorei)                         \
  X(READBUFFER, ReadBuffer)                           \
  X(READPIXELS, ReadPixels)                           \
  X(RENDERBUFFERSTORAGE, RenderbufferStorage)         \
  X(SCISSOR, Scissor)                                 \
  X(SHADERSOURCE, ShaderSource)                       \
  X(TEXIMAGE2D, TexImage2D)                           \
  X(TEXPARAMETERI, TexParameteri)                     \
  X(UNIFORM1F, Uniform1f)                             \
  X(UNIFORM1I, Uniform1i)                             \
  X(UNIFORM3F, Uniform3f)                             \
  X(UNIFORMMATRIX4FV, UniformMatrix4fv)               \
  X(USEPROGRAM, UseProgram)                           \
  X(VERTEXATTRIBPOINTER, VertexAttribPointer)         \
  X(VIEWPORT, Viewport)

struct Gl {
#define KAZ_GL_MEMBER(TYPE, Name) PFNGL##TYPE##PROC Name = nullptr;
  KAZ_GL_FUNCTIONS(KAZ_GL_MEMBER)
#undef KAZ_GL_MEMBER

  // Looks up all functions. The context must be current. If a function is missing, returns Fault::environment
  // with the name of the function.
  static Result<Gl> load(GlContext& context);
};

}  // namespace kaz::sim
