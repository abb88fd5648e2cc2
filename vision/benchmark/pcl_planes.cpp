// PCL's plane segmentation of organised clouds, beside ours in the same run; only where installed.
// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>

#include <vector>

#include <pcl/features/integral_image_normal.h>
#include <pcl/point_types.h>
#include <pcl/segmentation/organized_multi_plane_segmentation.h>

#include "vision/benchmark/corner_scene.h"

namespace kaz::vision {
namespace {

// From points to refined plane regions: normals by integral images, then connected components of
// like planes (A. Trevor et al., 2013), with that method's settings in PCL's own example, but for
// the smallest region, which is ours, and the distance, which allows for stereo's noise at 1 m.
void peer_planes(benchmark::State& state, int width) {
  const DepthImage image = corner_scene(width);
  PointCloud points;
  point_cloud(image, points);
  const pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>(
      static_cast<std::uint32_t>(image.width), static_cast<std::uint32_t>(image.height)));
  for (std::size_t i = 0; i < points.points.size(); ++i) {
    const Eigen::Vector3f& p = points.points[i];
    (*cloud)[i] = {p.x(), p.y(), p.z()};
  }
  cloud->is_dense = false;
  pcl::IntegralImageNormalEstimation<pcl::PointXYZ, pcl::Normal> normals;
  normals.setNormalEstimationMethod(normals.COVARIANCE_MATRIX);
  normals.setMaxDepthChangeFactor(0.02F);
  normals.setNormalSmoothingSize(20);
  pcl::OrganizedMultiPlaneSegmentation<pcl::PointXYZ, pcl::Normal, pcl::Label> finder;
  finder.setMinInliers(static_cast<unsigned>(0.006 * image.width * image.height));
  finder.setAngularThreshold(0.017453 * 3);
  finder.setDistanceThreshold(0.02);
  std::size_t found = 0;
  for (auto _ : state) {
    const pcl::PointCloud<pcl::Normal>::Ptr normal(new pcl::PointCloud<pcl::Normal>);
    normals.setInputCloud(cloud);
    normals.compute(*normal);
    finder.setInputCloud(cloud);
    finder.setInputNormals(normal);
    using Region = pcl::PlanarRegion<pcl::PointXYZ>;
    std::vector<Region, Eigen::aligned_allocator<Region>> regions;
    finder.segmentAndRefine(regions);
    found = regions.size();
  }
  state.counters["segments"] = static_cast<double>(found);
}

BENCHMARK_CAPTURE(peer_planes, 320, 320)
    ->Name("peer.pcl_planes_ms.320")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(peer_planes, 640, 640)
    ->Name("peer.pcl_planes_ms.640")
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace kaz::vision
