// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/part/height_defects.h"

#include <numeric>
#include <vector>

namespace glint {
namespace {

/// What a grey sensor sees of a colour: red, green and blue count a third each. The sensor has no
/// spectrum to weigh them by.
double grey_of(const std::vector<double>& colour) {
  return std::accumulate(colour.begin(), colour.end(), 0.0) / static_cast<double>(colour.size());
}

}  // namespace

HeightFeature height_feature(const Defect& defect, const DefectGroup& group) {
  HeightFeature feature;
  feature.kind =
      is_line(defect.type) ? HeightFeature::Kind::kScratch : HeightFeature::Kind::kGaussian;
  feature.label = defect.label;
  feature.id = defect.id;
  feature.centre_mm = defect.place.centre_mm;
  feature.u_axis = defect.place.u_axis;
  feature.v_axis = defect.place.v_axis;
  feature.normal = defect.place.normal;
  feature.height_mm = defect.type == DefectType::kBump    ? defect.depth_mm
                      : defect.type == DefectType::kStain ? 0.0
                                                          : -defect.depth_mm;
  feature.sigma_mm = defect.diameter_mm / 4.0;
  feature.length_mm = defect.length_mm;
  feature.width_mm = defect.width_mm;
  feature.moves_position = group.moves_position;
  if (defect.type == DefectType::kStain) {
    feature.reflectance = grey_of(group.colour);
    feature.roughness_rad = group.stain_roughness_rad;
  }
  return feature;
}

}  // namespace glint
