// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/definition/defect_settings.h"

#include <array>
#include <cmath>

#include <fmt/format.h>

namespace glint {
namespace {

constexpr std::array<std::string_view, 6> kTypeNames = {
    "dent", "bump", "scratch", "pit", "gouge", "stain"};
constexpr std::array<std::string_view, 4> kRealisationNames = {
    "auto", "normal", "displaced", "imprinted"};
constexpr std::array<std::string_view, 4> kRegionNames = {"all", "box", "sphere", "faces"};
constexpr std::array<std::string_view, 2> kThinNames = {"clamp", "refuse"};
constexpr std::array<std::string_view, 2> kSubdivisionNames = {"midpoint", "loop"};

constexpr Count kPoint = {.min = 3, .max = 3};

void require_whole(KeyVisitor& keys, std::string_view key, const Interval& count) {
  keys.require(count.min == std::floor(count.min) && count.max == std::floor(count.max),
               key,
               "must be a whole number, or [min, max] of whole numbers");
}

void visit_region(KeyVisitor& keys, DefectRegion& r) {
  keys.choice("region",
              r.kind,
              kRegionNames,
              "where random places lie: all over the surface in proportion to its area, in a box, "
              "in a sphere, or on painted faces");
  keys.numbers("region_min_mm", r.min_mm, kPoint, Range{}, "box: corner in the part's frame");
  keys.numbers("region_max_mm", r.max_mm, kPoint, Range{}, "box: opposite corner");
  keys.numbers("region_centre_mm", r.centre_mm, kPoint, Range{}, "sphere: in the part's frame");
  keys.number("region_radius_mm", r.radius_mm, Range::positive(), "sphere: radius");
  keys.file("region_file",
            r.file,
            "faces: PLY of the part's own triangles with face colours; faces that are not black "
            "are allowed");
  keys.number("facing_deg",
              r.facing_rad,
              Range{.min = 0.0, .max = 180.0, .min_excluded = true},
              "random places only where the normal is within this angle of the part's z axis");
  for (std::size_t i = 0; i < 3; ++i) {
    keys.require(r.kind != DefectRegion::Kind::kBox || r.min_mm[i] < r.max_mm[i],
                 "region_max_mm",
                 "must be larger than region_min_mm on every axis");
  }
  keys.require(r.kind != DefectRegion::Kind::kFaces || !r.file.empty(),
               "region",
               "\"faces\" needs a region_file");
}

bool has_places_from_above(const DefectGroup& group) {
  const DefectGroup unset;
  const bool has_any = !group.x_mm.empty() || !group.y_mm.empty();
  return has_any && (group.x_mm != unset.x_mm || group.y_mm != unset.y_mm);
}

/// The one place in the part's middle is meant where a table says nothing of count or places.
void drop_unwanted_place(const KeyVisitor& keys, DefectGroup& g) {
  const bool gives_places =
      keys.is_given("x_mm") || keys.is_given("y_mm") || keys.is_given("at_mm");
  if (keys.is_given("count") && g.count.max <= 0.0 && !gives_places) {
    g.x_mm.clear();
    g.y_mm.clear();
  }
}

void visit_places(KeyVisitor& keys, DefectGroup& g) {
  const Range whole = {.min = 0.0, .max = 1e5};
  keys.interval("count",
                g.count,
                whole,
                "random places, a number or [min, max]; 0: the fixed places x_mm, y_mm or at_mm, "
                "none where none are given");
  keys.number("share", g.share, Range::positive(), "of imprint.count that this group gets");
  drop_unwanted_place(keys, g);
  keys.numbers("x_mm", g.x_mm, {}, Range{}, "places on the part, along the tunnel axis");
  keys.numbers("y_mm", g.y_mm, {}, Range{}, "places on the part, across, as many as x_mm");
  keys.numbers("at_mm",
               g.at_mm,
               {},
               Range{},
               "places as x, y, z, x, y, z ... in the part's frame, put onto the nearest surface; "
               "instead of x_mm and y_mm");
  visit_region(keys, g.region);
  keys.number("min_distance_mm",
              g.min_distance_mm,
              Range::at_least(0),
              "random places: between the rims of two defects");
  keys.number("edge_distance_mm",
              g.edge_distance_mm,
              Range::at_least(0),
              "random places: from a defect's centre to the part's sharp edges");
  require_whole(keys, "count", g.count);
  keys.require(
      g.x_mm.size() == g.y_mm.size(),
      "y_mm",
      fmt::format("has {} places but x_mm has {}, must be as many", g.y_mm.size(), g.x_mm.size()));
  keys.require(g.at_mm.size() % 3 == 0,
               "at_mm",
               fmt::format("has {} numbers, must be three for each place", g.at_mm.size()));
  keys.require(g.at_mm.empty() || !has_places_from_above(g),
               "at_mm",
               "is given together with x_mm or y_mm, must be one of them");
  keys.require(g.count.max <= 0.0 || !has_given_places(g),
               "count",
               "random places and at_mm, x_mm or y_mm exclude each other; give one of them");
}

void visit_sizes(KeyVisitor& keys, DefectGroup& g) {
  const Range size = {.min = 1e-3, .max = 1e3};
  keys.interval("height_um",
                g.height_mm,
                Range{.min = 1e-4, .max = 1e5},
                "depth along the normal, height of a bump; this and all sizes: a number or a range "
                "[min, max] that each defect draws from");
  keys.interval("diameter_mm",
                g.diameter_mm,
                size,
                "dent, bump, pit, stain: 4 sigma of the Gaussian; imprinted: of the opening");
  keys.interval("length_mm", g.length_mm, size, "scratch, gouge: from end to end");
  keys.interval("width_mm",
                g.width_mm,
                size,
                "scratch, gouge: 4 sigma of its cross-section; imprinted: of the opening");
  keys.interval("angle_deg",
                g.angle_rad,
                Range::between(-180, 180),
                "turn about the normal, from the part's x axis");
  keys.interval("tilt_deg",
                g.tilt_rad,
                Range::between(0, 45),
                "imprinted: tilt of the tool against the normal, towards any side");
  keys.boolean("moves_position",
               g.moves_position,
               "normal: whether the height also moves the surface, not only its normal");
}

void visit_tools(KeyVisitor& keys, DefectGroup& g) {
  keys.number("roughness",
              g.roughness,
              Range::between(0, 0.5),
              "imprinted: noise of a procedural tool, rms share of its radius");
  keys.integer(
      "tool_level",
      g.tool_level,
      Range::between(1, 7),
      "imprinted: fineness of a procedural tool; a round one has about 20 * 4^level triangles");
  keys.file(
      "tool_folder",
      g.tool_folder,
      "imprinted: folder of custom closed tools (STL, PLY, OBJ, OFF, mm; z = 0 is the surface, "
      "+z outwards); each is scaled to the drawn size; empty: procedural tools");
  keys.number("wall_share",
              g.wall_share,
              Range{.min = 0.0, .max = 1.0, .min_excluded = true},
              "largest depth as a share of the wall's thickness");
  keys.choice("when_thin",
              g.when_thin,
              kThinNames,
              "a deeper defect is made shallower, or another place is drawn");
}

/// Fixed places of a group.
std::size_t num_places(const DefectGroup& group) {
  return group.at_mm.empty() ? group.x_mm.size() : group.at_mm.size() / 3;
}

}  // namespace

std::string_view type_name(DefectType type) {
  return kTypeNames[static_cast<std::size_t>(type)];
}

std::string_view realisation_name(Realisation realisation) {
  return kRealisationNames[static_cast<std::size_t>(realisation)];
}

void visit_keys(KeyVisitor& keys, DefectGroup& g) {
  keys.choice("type",
              g.type,
              kTypeNames,
              "dents, pits, scratches and gouges go inwards, bumps outwards, stains are flat");
  keys.choice("realisation",
              g.realisation,
              kRealisationNames,
              "normal: the height tilts the normal; displaced: a fine mesh is moved; imprinted: a "
              "tool is cut out; auto: the cheapest within the tolerance");
  visit_places(keys, g);
  visit_sizes(keys, g);
  visit_tools(keys, g);
  keys.number("tolerance",
              g.tolerance,
              Range{.min = 1e-4, .max = 1.0},
              "auto: allowed error of the picture as a share of the defect's contrast");
  keys.numbers("colour",
               g.colour,
               {.min = 1, .max = 3},
               Range::between(0, 1),
               "stain: reflectance against the clean surface, grey or red, green, blue");
  keys.number("stain_roughness_deg",
              g.stain_roughness_rad,
              Range::between(0, 30),
              "stain: rms slope of its micro relief, 0: as smooth as the part");
  keys.require(g.colour.size() != 2, "colour", "has 2 numbers, must be 1 (grey) or 3");
}

bool uses_key(DefectType type, std::string_view key) {
  const bool is_drawn_out = type == DefectType::kScratch || type == DefectType::kGouge;
  if (key == "length_mm" || key == "width_mm") {
    return is_drawn_out;
  }
  if (key == "diameter_mm") {
    return !is_drawn_out;
  }
  if (key == "colour" || key == "stain_roughness_deg") {
    return type == DefectType::kStain;
  }
  return true;
}

DefectType type_from_name(const std::string& name) {
  for (std::size_t i = 0; i < kTypeNames.size(); ++i) {
    if (name.starts_with(kTypeNames[i])) {
      return static_cast<DefectType>(i);
    }
  }
  return DefectType::kDent;
}

bool has_given_places(const DefectGroup& group) {
  return !group.at_mm.empty() || has_places_from_above(group);
}

std::size_t max_defects(const DefectGroup& group, const ImprintSettings& settings) {
  if (settings.count.max > 0.0) {
    return static_cast<std::size_t>(settings.count.max);
  }
  return group.count.max > 0.0 ? static_cast<std::size_t>(group.count.max) : num_places(group);
}

void visit_keys(KeyVisitor& keys, ImprintSettings& s) {
  keys.integer("seed", s.seed, Range::at_least(0), "of places, sizes and tools");
  keys.interval("count",
                s.count,
                Range{.min = 0.0, .max = 1e5},
                "defects in total, a number or [min, max], drawn among the groups by their "
                "`share`; 0: each group's own count");
  require_whole(keys, "count", s.count);
  keys.integer("max_attempts",
               s.max_attempts,
               Range::between(1, 10000),
               "fresh samples for one defect before it is given up");
  keys.integer("jitters",
               s.jitters,
               Range::between(0, 100),
               "small moves of a tool that is refused, before a fresh sample");
  keys.number("min_removed_mm3",
              s.min_removed_mm3,
              Range::at_least(0),
              "imprints that remove less are sampled again");
  keys.boolean("may_be_fewer", s.may_be_fewer, "false: a defect that is given up is an error");
  keys.table(
      "processing",
      [&](KeyVisitor& inner) {
        ProcessingSettings& p = s.processing;
        inner.choice("subdivision", p.subdivision, kSubdivisionNames, "how triangles are cut");
        inner.integer("levels", p.levels, Range::between(0, 4), "each makes 4 triangles of one");
        inner.number("face_normal_noise_deg",
                     p.face_normal_noise_rad,
                     Range::between(0, 10),
                     "rms tilt of every triangle's shading normal");
        inner.number("vertex_noise_um",
                     p.vertex_noise_mm,
                     Range::between(0, 1e4),
                     "rms move of every vertex along its normal");
        inner.number("edge_roughness_um",
                     p.edge_roughness_mm,
                     Range::between(0, 1e4),
                     "rms move of vertices on sharp edges");
      },
      "noise and subdivision of the finished mesh");
}

}  // namespace glint
