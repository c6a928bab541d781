// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/height_defects.h"

#include <array>

#include <fmt/format.h>

namespace glint {
namespace {

using Type = DefectGroup::Type;

constexpr std::array<std::string_view, 3> kTypeNames = {"dent", "bump", "scratch"};

HeightFeature shape_of(const DefectGroup& group) {
  HeightFeature feature;
  const bool is_scratch = group.type == Type::kScratch;
  feature.kind = is_scratch ? HeightFeature::Kind::kScratch : HeightFeature::Kind::kGaussian;
  feature.height_mm = group.type == Type::kBump ? group.height_mm : -group.height_mm;
  feature.sigma_mm = group.diameter_mm / 4.0;
  feature.length_mm = group.length_mm;
  feature.width_mm = group.width_mm;
  feature.moves_position = group.moves_position;
  return feature;
}

}  // namespace

void visit_keys(KeyVisitor& keys, DefectGroup& g) {
  const Range size = {.min = 1e-3, .max = 1e3};
  keys.choice("type", g.type, kTypeNames, "dents and scratches go inwards, bumps outwards");
  keys.numbers("x_mm", g.x_mm, {.min = 1}, Range{}, "places on the part, along the tunnel axis");
  keys.numbers("y_mm", g.y_mm, {.min = 1}, Range{}, "places on the part, across, as many as x_mm");
  keys.number("height_um",
              g.height_mm,
              Range{.min = 1e-4, .max = 1e5},
              "depth of a dent or scratch, height of a bump");
  keys.number("diameter_mm", g.diameter_mm, size, "dent, bump: 4 sigma of the Gaussian");
  keys.number("length_mm", g.length_mm, size, "scratch: from end to end");
  keys.number("width_mm", g.width_mm, size, "scratch: 4 sigma of its Gaussian cross-section");
  keys.number("angle_deg", g.angle_rad, Range::between(-180, 180), "scratch: from the x axis");
  keys.boolean("moves_position",
               g.moves_position,
               "whether the height also moves the surface, not only its normal");
  keys.require(
      g.x_mm.size() == g.y_mm.size(),
      "y_mm",
      fmt::format("has {} places but x_mm has {}, must be as many", g.y_mm.size(), g.x_mm.size()));
}

Type type_from_name(const std::string& name) {
  for (std::size_t i = 0; i < kTypeNames.size(); ++i) {
    if (name.starts_with(kTypeNames[i])) {
      return static_cast<Type>(i);
    }
  }
  return Type::kDent;
}

std::vector<HeightFeature> make_features(const std::string& name,
                                         const DefectGroup& group,
                                         const Part& part,
                                         const Bvh& bvh,
                                         int first_id) {
  std::vector<HeightFeature> features;
  for (std::size_t i = 0; i < group.x_mm.size(); ++i) {
    const auto place = place_on_surface(part, bvh, group.x_mm[i], group.y_mm[i], group.angle_rad);
    if (!place) {
      throw ConfigError(fmt::format(
          "defects.{}: place {} at x {:g} mm, y {:g} mm is beside the part; the part reaches over "
          "{:g} x {:g} mm",
          name,
          i + 1,
          group.x_mm[i],
          group.y_mm[i],
          part.box_in_part_mm.size_mm().x(),
          part.box_in_part_mm.size_mm().y()));
    }
    HeightFeature feature = shape_of(group);
    feature.label = fmt::format("{}_{}", name, i + 1);
    feature.id = first_id + static_cast<int>(i);
    feature.centre_mm = place->centre_mm;
    feature.u_axis = place->u_axis;
    feature.v_axis = place->v_axis;
    feature.normal = place->normal;
    features.push_back(feature);
  }
  return features;
}

}  // namespace glint
