// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "simulator/light/area/emitter.h"

namespace glint {

/// Emitters in a binary tree of boxes: to meet them with rays, and to choose one with a probability
/// that follows what it may contribute at a point. Where an emitter can contribute it can be
/// chosen, unless it is not to be drawn.
///
/// Up to eight emitters are weighed one by one. A node's estimate is its intensity times the cos^n
/// of the smallest angle between a normal in it and the way to the point, over the square of the
/// distance (at least half its diagonal). Source: A. Conty Estevez, C. Kulla, "Importance sampling
/// of many lights with adaptive tree splitting", HPG 2018, as in pbrt-v4.
class LightTree {
 public:
  LightTree() = default;
  LightTree(const std::vector<Emitter>& emitters, const std::vector<IesBody>& bodies);

  struct Choice {
    int emitter = -1;
    double probability = 0.0;
    double u = 0.0;  ///< what remains of the random number, uniform in [0, 1) again
  };

  /// Empty when no emitter can shine on that point. @param u  in [0, 1)
  std::optional<Choice> choose(const std::vector<Emitter>& emitters,
                               const Eigen::Vector3d& point_mm,
                               double u) const;

  /// With which choose() takes that emitter.
  double probability(const std::vector<Emitter>& emitters,
                     const Eigen::Vector3d& point_mm,
                     int emitter) const;

  /// Estimate of the irradiance at a point from all emitters, W / m^2 (order of magnitude).
  double estimate_w_m2(const std::vector<Emitter>& emitters, const Eigen::Vector3d& point_mm) const;

  struct Hit {
    int emitter = -1;
    ShapeCrossing crossing;
  };

  /// The nearest front, or back of a solid emitter, that the ray meets before max_mm.
  std::optional<Hit> hit(const std::vector<Emitter>& emitters, const Ray& ray, double max_mm) const;

 private:
  struct Node {
    Eigen::AlignedBox3d box_mm;
    NormalCone cone;
    double intensity = 0.0;  ///< W / sr, sum
    double exponent = 0.0;   ///< smallest
    int right = -1;          ///< the left child follows its parent
    int emitter = -1;        ///< >= 0: a leaf
  };

  std::optional<Choice> choose_of_few(const std::vector<Emitter>& emitters,
                                      const Eigen::Vector3d& point_mm,
                                      double u) const;
  double probability_of_few(const std::vector<Emitter>& emitters,
                            const Eigen::Vector3d& point_mm,
                            int emitter) const;
  int build(
      std::vector<int>& order, std::size_t begin, std::size_t end, std::uint64_t trail, int depth);
  double importance(const std::vector<Emitter>& emitters,
                    const Node& node,
                    const Eigen::Vector3d& point_mm) const;

  std::vector<Node> leaves_;  ///< while building
  std::vector<Node> nodes_;
  std::vector<std::uint64_t> trails_;  ///< per emitter: 1 = right, from the root upwards in bits
};

}  // namespace glint
