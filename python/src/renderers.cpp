// Renderers of one scene for many robots: one for each thread that draws.
// SPDX-License-Identifier: Apache-2.0
#include "python/src/renderers.h"

#include <utility>

namespace kaz::python {
namespace {

class Shared final : public sim::Renderer {
 public:
  explicit Shared(Renderers& all) : all_(all) {}
  Result<void> set_scene(const sim::Scene& scene) override {
    static_cast<void>(scene);
    return {};
  }
  Result<void> render(const sim::ScenePose& pose, const sim::View& view,
                      vision::Image& picture) override {
    return KAZ_TRY(all_.mine())->render(pose, view, picture);
  }

 private:
  Renderers& all_;
};

}  // namespace

Result<sim::Renderer*> Renderers::mine() {
  const std::lock_guard lock(mutex_);
  auto& mine = made_[std::this_thread::get_id()];
  if (!mine) {
    auto renderer = KAZ_TRY(factory_());
    KAZ_TRY(renderer->set_scene(scene_));
    mine = std::move(renderer);
  }
  return mine.get();
}

sim::RendererFactory Renderers::shared() {
  return [this]() -> Result<std::unique_ptr<sim::Renderer>> {
    return std::make_unique<Shared>(*this);
  };
}

}  // namespace kaz::python
