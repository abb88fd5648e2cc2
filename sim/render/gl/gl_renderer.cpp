// Renderer: creates the context at the first use, a framebuffer for each picture size, reads pixels back.
// SPDX-License-Identifier: Apache-2.0
#include "sim/render/gl/gl_renderer.h"

#include <optional>

#include "sim/render/gl/gl_scene.h"
#include "sim/render/model/resample.h"
#include "sim/render/model/visible.h"

namespace kaz::sim {

namespace {

struct Target {
  int width = 0, height = 0;
  GLuint framebuffer = 0, color = 0, depth = 0;
};

// Makes the context current for a scope. Other contexts of the process may be used in between.
class Current {
 public:
  explicit Current(GlContext& context) : context_(context) {}
  ~Current() { context_.release(); }
  Current(const Current&) = delete;
  Current& operator=(const Current&) = delete;

 private:
  GlContext& context_;
};

class GlRenderer final : public Renderer {
 public:
  explicit GlRenderer(ContextMaker make_context) : make_context_(std::move(make_context)) {}

  Result<void> set_scene(const Scene& scene) override {
    if (model_)
      return fail(Fault::usage, "a renderer accepts only one scene: create another renderer");
    Result<SceneModel> model = build_scene_model(scene);
    if (!model) return tl::unexpected(model.error());
    model_ = std::make_unique<SceneModel>(std::move(*model));
    return {};
  }

  Result<void> render(const ScenePose& pose, const View& view, vision::Image& picture) override {
    if (!model_) return fail(Fault::usage, "a renderer needs a scene before its first picture");
    if (auto checked = check_view(model_->frames, pose, view); !checked) return checked;
    if (!context_) {
      Result<std::unique_ptr<GlContext>> context = make_context_();
      if (!context) return tl::unexpected(context.error());
      context_ = std::move(*context);
    }
    if (Result<void> made = context_->make_current(); !made) return made;
    const Current current(*context_);
    if (!scene_) {
      if (Result<void> started = start(); !started) return started;
    }
    const int n = view.samples_per_axis;
    Result<const Target*> target = target_for(view.camera.width * n, view.camera.height * n);
    if (!target) return tl::unexpected(target.error());
    scene_->draw(pose, view, (*target)->framebuffer);
    return read_back(**target, n, picture);
  }

 private:
  Result<void> start() {
    Result<Gl> gl = Gl::load(*context_);
    if (!gl) return tl::unexpected(gl.error());
    gl_ = std::make_unique<Gl>(*gl);
    Result<GlScene> scene = GlScene::create(*gl_, *model_);
    if (!scene) return tl::unexpected(scene.error());
    scene_.emplace(std::move(*scene));
    return {};
  }

  Result<const Target*> target_for(int width, int height) {
    for (const Target& t : targets_) {
      if (t.width == width && t.height == height) return &t;
    }
    Target t{width, height};
    gl_->GenFramebuffers(1, &t.framebuffer);
    gl_->BindFramebuffer(GL_FRAMEBUFFER, t.framebuffer);
    const auto attach = [&](GLuint& buffer, GLenum format, GLenum attachment) {
      gl_->GenRenderbuffers(1, &buffer);
      gl_->BindRenderbuffer(GL_RENDERBUFFER, buffer);
      gl_->RenderbufferStorage(GL_RENDERBUFFER, format, width, height);
      gl_->FramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, buffer);
    };
    attach(t.color, GL_RGBA8, GL_COLOR_ATTACHMENT0);
    attach(t.depth, GL_DEPTH_COMPONENT24, GL_DEPTH_ATTACHMENT);
    if (gl_->CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
      gl_->DeleteFramebuffers(1, &t.framebuffer);
      gl_->DeleteRenderbuffers(1, &t.color);
      gl_->DeleteRenderbuffers(1, &t.depth);
      return fail(Fault::environment, "OpenGL has no memory for a picture of " +
                                          std::to_string(width) + " x " + std::to_string(height) +
                                          " samples: request a smaller picture");
    }
    targets_.push_back(t);
    return &targets_.back();
  }

  Result<void> read_back(const Target& target, int n, vision::Image& picture) {
    samples_.resize(static_cast<std::size_t>(target.width) *
                    static_cast<std::size_t>(target.height) * 4);
    gl_->PixelStorei(GL_PACK_ALIGNMENT, 4);
    gl_->ReadPixels(0, 0, target.width, target.height, GL_RGBA, GL_UNSIGNED_BYTE, samples_.data());
    if (const GLenum error = gl_->GetError(); error != GL_NO_ERROR) {
      return fail(Fault::environment, "OpenGL failed while drawing a picture (error " +
                                          std::to_string(error) + "): check the free memory");
    }
    picture.width = target.width / n;
    picture.height = target.height / n;
    pack_rgb(samples_, target.width, target.height, n, picture.rgb);
    return {};
  }

  ContextMaker make_context_;
  std::unique_ptr<SceneModel> model_;
  // Members are destroyed in reverse order; OpenGL objects are freed with the context.
  std::unique_ptr<GlContext> context_;
  std::unique_ptr<Gl> gl_;
  std::optional<GlScene> scene_;
  std::vector<Target> targets_;
  std::vector<std::uint8_t> samples_;
};

}  // namespace

std::unique_ptr<Renderer> make_gl_renderer(ContextMaker make_context) {
  return std::make_unique<GlRenderer>(std::move(make_context));
}

}  // namespace kaz::sim
