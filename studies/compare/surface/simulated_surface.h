// SPDX-License-Identifier: GPL-3.0-or-later
//
// The surface that a rendered view shows, pixel by pixel: geometry.exr of `glint render`.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/image/image.h"
#include "core/pose.h"
#include "simulator/camera/pinhole_camera.h"

namespace glint {

/// Points and normals of the part, by pixel.
class SimulatedSurface {
 public:
  /// @param geometry  an OpenEXR file with depth_mm, position_mm.x, .y, .z and normal.x, .y, .z
  /// @param width_px, height_px  of the picture that it belongs to
  /// @param camera_from_scene  of the view
  /// @throws IoError where it cannot be read, ConfigError where it lacks a channel or has another
  /// size than the picture
  SimulatedSurface(const std::filesystem::path& geometry,
                   int width_px,
                   int height_px,
                   const RigidTransform& camera_from_scene);

  int width() const { return channels_[0].width(); }

  int height() const { return channels_[0].height(); }

  bool is_part(int x, int y) const { return channels_[kDepth](x, y) > 0.0F; }

  /// In the scene's frame; where the pixel is on the part.
  Eigen::Vector3d point_mm(int x, int y) const;
  Eigen::Vector3d normal(int x, int y) const;

  /// Along the camera's axis. @returns 0 beside the part
  double depth_mm(int x, int y) const;

  /// The point of the part at an edge, in the camera's frame. Pixels beside an edge mix what lies
  /// on both sides of it, so depth is taken from some pixels within and led on to the edge: in a
  /// picture of a plane 1 / z is a linear function. Of two sides that both show the part the nearer
  /// one makes the edge.
  std::optional<Eigen::Vector3d> at_edge(const PinholeCamera& camera,
                                         const Eigen::Vector2d& at_px,
                                         const Eigen::Vector2d& normal) const;

  /// Along the normal, to either side, from an edge to the nearest other one: where the part ends
  /// or begins, two faces meet, or one lies behind the other. Edges within 2 px of it are not told
  /// from it. @return infinite where there is none within the reach
  double free_px(const Eigen::Vector2d& at_px,
                 const Eigen::Vector2d& normal,
                 double reach_px) const;

  /// Mean of all its pixels, in the camera's frame; (0, 0, 1) where there are none.
  Eigen::Vector3d middle_mm() const;

 private:
  static constexpr std::size_t kDepth = 6;

  Eigen::Vector3d in_camera_mm(int x, int y) const;
  double inverse_depth(const Eigen::Vector2d& at_px) const;
  bool is_edge_between(const Eigen::Vector2d& first_px, const Eigen::Vector2d& second_px) const;
  bool is_within(const Eigen::Vector2d& at_px) const;

  RigidTransform camera_from_scene_;
  std::vector<ImageF> channels_;
};

}  // namespace glint
