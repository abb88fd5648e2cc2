// Pairs of pictures, cameras at a port, camera models.
// SPDX-License-Identifier: Apache-2.0
#include "python/src/python.h"

#include "tools/run/live_camera.h"

namespace kaz::python {
namespace {

using Pixels = std::shared_ptr<const vision::StereoImages>;

py::array picture_of(const Pair& pair, bool right) {
  const vision::Image& image = right ? pair.images->right : pair.images->left;
  // The array keeps the pair's pixels alive.
  py::capsule owner(new Pixels(pair.images), [](void* held) { delete static_cast<Pixels*>(held); });
  py::array_t<std::uint8_t> array({image.height, image.width, 3}, image.rgb.data(), owner);
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

// A camera of another process, or a real one.
using Camera = Locked<vision::Camera>;

std::unique_ptr<Camera> open_camera(const std::string& path, const std::string& calibration) {
  auto opened = value_of(released([&] { return tools::open_live_camera(path, calibration); }));
  return std::make_unique<Camera>("this Camera", std::move(opened.camera));
}

std::optional<Pair> poll(Camera& camera) {
  return value_of(camera.alone([](vision::Camera& c) -> Result<std::optional<Pair>> {
    const auto pair = KAZ_TRY(c.poll());
    return pair ? std::optional(pair_of(*pair)) : std::nullopt;
  }));
}

}  // namespace

Pair pair_of(const vision::StereoPair& pair) {
  return {pair.info, pair.images.get()};
}

vision::Image image_of(
    const py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast>& picture) {
  if (picture.ndim() != 3 || picture.shape(2) != 3)
    raise({Fault::usage, "a picture must be an array of height x width x 3 bytes (RGB)"});
  vision::Image image;
  image.height = static_cast<int>(picture.shape(0));
  image.width = static_cast<int>(picture.shape(1));
  image.rgb.assign(picture.data(), picture.data() + picture.size());
  return image;
}

void add_pictures(py::module_& module) {
  py::class_<vision::CameraModel>(module, "CameraModel")
      .def(py::init([](int width, int height, double fx, double fy, double cx, double cy,
                       double baseline_m) {
             return vision::CameraModel{width, height, fx, fy, cx, cy, baseline_m};
           }),
           py::arg("width"), py::arg("height"), py::arg("fx"), py::arg("fy"), py::arg("cx"),
           py::arg("cy"), py::arg("baseline_m") = 0.0)
      .def_readonly("width", &vision::CameraModel::width)
      .def_readonly("height", &vision::CameraModel::height)
      .def_readonly("fx", &vision::CameraModel::fx)
      .def_readonly("fy", &vision::CameraModel::fy)
      .def_readonly("cx", &vision::CameraModel::cx)
      .def_readonly("cy", &vision::CameraModel::cy)
      .def_readonly("baseline_m", &vision::CameraModel::baseline_m);
  py::class_<Pair>(module, "Pair")
      .def_property_readonly("left", [](const Pair& pair) { return picture_of(pair, false); })
      .def_property_readonly("right", [](const Pair& pair) { return picture_of(pair, true); })
      .def_property_readonly("sequence", [](const Pair& pair) { return pair.info.sequence; })
      .def_property_readonly("time", [](const Pair& pair) { return seconds(pair.info.exposure); })
      .def_property_readonly("camera", [](const Pair& pair) { return pair.info.camera; });
  py::class_<Camera>(module, "Camera")
      .def(py::init(&open_camera), py::arg("path"), py::arg("calibration") = "")
      .def("poll", &poll)
      .def_property_readonly("model", [](Camera& camera) {
        return camera.alone([](vision::Camera& c) { return c.model(); });
      });
}

}  // namespace kaz::python
