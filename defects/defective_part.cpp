// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/defective_part.h"

#include <cmath>

#include <fmt/format.h>

#include "defects/height_defects.h"

namespace glint {

struct DefectMaker::State {
  std::shared_ptr<const Part> part;
  std::shared_ptr<const Bvh> bvh;
  std::vector<NamedGroup> groups;
  ImprintSettings settings;
};

DefectMaker::DefectMaker(std::shared_ptr<const Part> part,
                         std::shared_ptr<const Bvh> bvh,
                         std::vector<NamedGroup> groups,
                         const ImprintSettings& settings,
                         double)
    : state_(std::make_unique<const State>(
          State{std::move(part), std::move(bvh), std::move(groups), settings})) {}

DefectMaker::~DefectMaker() = default;
DefectMaker::DefectMaker(DefectMaker&&) noexcept = default;
DefectMaker& DefectMaker::operator=(DefectMaker&&) noexcept = default;

const Part* DefectMaker::part() const {
  return state_->part.get();
}

DefectivePart DefectMaker::make(std::uint64_t,
                                const ChooseRealisation&,
                                const std::function<void(int)>&) const {
  DefectivePart result;
  const Part& part = *state_->part;
  for (const auto& [name, group] : state_->groups) {
    for (std::size_t i = 0; i < group.x_mm.size(); ++i) {
      const double angle = group.angle_rad.min;
      const auto place = place_on_surface(part, *state_->bvh, group.x_mm[i], group.y_mm[i], angle);
      if (!place) {
        throw ConfigError(
            fmt::format("defects.{}: place {} at x {:g} mm, y {:g} mm is beside the part; the part "
                        "reaches over "
                        "{:g} x {:g} mm",
                        name,
                        i + 1,
                        group.x_mm[i],
                        group.y_mm[i],
                        part.box_in_part_mm.size_mm().x(),
                        part.box_in_part_mm.size_mm().y()));
      }
      Defect defect;
      defect.label = fmt::format("{}_{}", name, i + 1);
      defect.group = name;
      defect.id = static_cast<std::int32_t>(result.defects.size()) + 1;
      defect.type = group.type;
      defect.place = *place;
      defect.depth_mm = group.height_mm.min;
      defect.diameter_mm = group.diameter_mm.min;
      defect.length_mm = group.length_mm.min;
      defect.width_mm = group.width_mm.min;
      result.defects.push_back({.defect = defect, .is_made = true, .attempts = 1});
      result.features.push_back(height_feature(defect, group));
      result.outlines.push_back(result.features.back());
    }
  }
  return result;
}

}  // namespace glint
