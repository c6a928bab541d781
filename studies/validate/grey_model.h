// SPDX-License-Identifier: GPL-3.0-or-later
//
// Small pictures of all views of a design for changed lights: what a fit of grey values compares.
// Private to the room.
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "studies/validate/grey_fit.h"

namespace glint::validate_detail {

/// Pixels of all views that take part, one after the other.
struct GreyColumns {
  Eigen::VectorXd sum;       ///< grey of all lights together
  Eigen::MatrixXd segments;  ///< grey of each segment of each light that has several
};

class GreyModel {
 public:
  GreyModel(SceneStore& store, std::span<const GreyView> views);

  const std::vector<LitLight>& lights() const { return lights_; }

  /// Real grey values.
  const Eigen::VectorXd& real() const { return real_; }

  /// Simulated ones with lights moved and roughness changed; powers and exposure stay. Kept.
  /// @param places_mm  of each light
  const GreyColumns& columns(const std::vector<Eigen::Vector3d>& places_mm, double roughness);

  /// Root mean square of the even part of a difference: of means over 3 x 3 of these pixels, less
  /// what noise that differs from pixel to pixel makes of it.
  double even_rms(const Eigen::VectorXd& difference) const;

  int renders() const { return renders_; }

 private:
  struct SmallView {
    SceneSettings scene;
    ImageF real;
    Mask used;
  };

  void choose_pixels();
  GreyColumns render(const SceneChange& change);
  std::vector<ImageF> group_pictures(const SceneSettings& scene,
                                     const std::vector<std::string>& names);
  std::vector<std::string> column_names() const;

  SceneStore& store_;
  std::vector<SmallView> views_;
  std::vector<LitLight> lights_;
  Eigen::VectorXd real_;
  std::map<std::string, GreyColumns> kept_;
  int renders_ = 0;
};

}  // namespace glint::validate_detail
