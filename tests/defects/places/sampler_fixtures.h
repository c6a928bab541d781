// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "defects/places/sampler.h"

namespace glint {

/// A part with its search tree and a sampler of some groups.
struct Sampled {
  Sampled(const PartSettings& settings,
          std::vector<NamedGroup> its_groups,
          const ImprintSettings& imprint = {})
      : part(build_part(settings)),
        bvh(part.mesh),
        groups(std::move(its_groups)),
        sampler(part, bvh, groups, imprint, 0.5) {}

  DefectSampler::Draw draw(std::uint64_t seed,
                           int number,
                           int attempt = 0,
                           std::span<const Defect> taken = {},
                           std::size_t group = 0) const {
    return sampler.draw(seed, {.group = group, .number = number, .id = number + 1}, attempt, taken);
  }

  /// Draws in slot order, each slot until it is accepted.
  std::vector<Defect> all(std::uint64_t seed) const {
    std::vector<Defect> defects;
    for (const DefectSlot& slot : sampler.slots(seed)) {
      for (int attempt = 0; attempt < 200; ++attempt) {
        if (const auto drawn = sampler.draw(seed, slot, attempt, defects); drawn.defect) {
          defects.push_back(*drawn.defect);
          break;
        }
      }
    }
    return defects;
  }

  Eigen::Vector3d in_part(const Defect& defect) const {
    return inverse(part.scene_from_part) * defect.place.centre_mm;
  }

  Part part;
  Bvh bvh;
  std::vector<NamedGroup> groups;
  DefectSampler sampler;
};

inline PartSettings sampler_plate() {
  return {.shape = PartSettings::Shape::kPlate,
          .length_mm = 60.0,
          .width_mm = 40.0,
          .thickness_mm = 2.0};
}

/// Turned and moved, so that frames cannot be mixed up.
inline PartSettings posed_part(PartSettings settings) {
  settings.position_mm = {10.0, -20.0, 5.0};
  settings.rotation_rad = {0.3, -0.8, 1.9};
  return settings;
}

inline DefectGroup sampler_dents(double count) {
  return {.count = count, .height_mm = 0.01, .diameter_mm = 1.0};
}

}  // namespace glint
