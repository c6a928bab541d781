// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/coverage/coverage_settings.h"

namespace glint {
namespace {

constexpr std::string_view kChoiceNames[] = {"greedy", "exact"};

void visit_light(KeyVisitor& keys, CoverageSettings& s) {
  keys.boolean("has_light", s.has_light, "whether brightness counts; else geometry alone");
  keys.number("min_grey",
              s.min_grey,
              Range::between(0.0, 1.0),
              "darkest mean of the frames that shows defects, share of full scale");
  keys.number("max_grey",
              s.max_grey,
              Range::between(0.0, 1.0),
              "a place whose frames are all brighter is clipped, share of full scale; 1: any");
  keys.number("min_lit_share",
              s.min_lit_share,
              Range::between(0.0, 1.0),
              "of a mirror under a tunnel: share of the scan's positions at which the mirrored ray "
              "meets the luminous wall");
  keys.integer("samples",
               s.samples,
               Range::between(1, 4096),
               "paths a pixel of the small pictures that brightness is read from");
  keys.require(s.min_grey <= s.max_grey, "min_grey", "must not be greater than max_grey");
}

}  // namespace

void visit_keys(KeyVisitor& keys, CoverageSettings& s) {
  keys.number("max_incidence_deg",
              s.max_incidence_rad,
              Range{.min = 0.0, .max = 90.0, .min_excluded = true},
              "largest angle between the surface's normal and the view");
  keys.number("max_pixel_um",
              s.max_pixel_mm,
              Range::between(0.0, 1e6),
              "longest stretch of the surface in one pixel; 0: any");
  keys.number("max_blur_px",
              s.max_blur_px,
              Range::positive(),
              "widest circle of confusion that is in focus");
  visit_light(keys, s);
  keys.number("separation_deg",
              s.separation_rad,
              Range::between(0.0, 180.0),
              "smallest angle between views that count as two for Ck; 0: all count");
  keys.number("defect_px",
              s.defect_px,
              Range::positive(),
              "pixels across the smallest defect that is found");
  keys.integer("points", s.points, Range::between(100, 10'000'000), "points on the surface, about");
  keys.integer("seed", s.seed, Range::between(0, 2147483647), "of where the points lie");
  keys.integer("choose",
               s.choose,
               Range::between(0, 10'000),
               "how many of the views are chosen; 0: all are used");
  keys.choice("choice",
              s.choice,
              kChoiceNames,
              "one view after the other, each that which adds most; or the best set there is, by "
              "branch and bound");
}

}  // namespace glint
