// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/inspection/inspection_settings.h"

#include <array>

namespace glint {
namespace {

constexpr std::array<std::string_view, 5> kFilters = {
    "gaussian", "difference_of_gaussians", "matched", "phase", "structure"};
constexpr std::array<std::string_view, 3> kThresholds = {"fixed", "noise", "false_alarms"};
constexpr std::array<std::string_view, 3> kPolarities = {"both", "bright", "dark"};
constexpr std::array<std::string_view, 2> kKindRules = {"elongation", "printed"};
constexpr std::array<std::string_view, 2> kMeasureNames = {"area", "weight"};

void visit_filter(KeyVisitor& keys, InspectionSettings& settings) {
  keys.choice("filter",
              settings.filter,
              kFilters,
              "gaussian: mean image minus its Gaussian; difference_of_gaussians: the largest of "
              "several scales; matched: correlation with a spot; phase: slopes from shifted "
              "stripes; structure: what varies along two directions, unlike grooves and edges");
  keys.integer("kernel_px",
               settings.kernel_px,
               Range::between(3, 255),
               "width of the Gaussian that is subtracted; odd");
  keys.require(settings.kernel_px % 2 == 1, "kernel_px", "must be odd");
  keys.number("sigma_px",
              settings.sigma_px,
              Range::between(0, 100),
              "sigma of that Gaussian; 0: 0.3 ((kernel_px - 1) / 2 - 1) + 0.8");
  keys.numbers("scales_px",
               settings.scales_px,
               {.min = 1, .max = 16},
               {.min = 0.3, .max = 100},
               "sigmas of the differences of Gaussians, each against 1.6 times as much");
  keys.number("template_px",
              settings.template_px,
              {.min = 1, .max = 400},
              "diameter (4 sigma) of the spot that the matched filter looks for");
  keys.number("structure_px",
              settings.structure_px,
              {.min = 2, .max = 400},
              "width (4 sigma) of the window over which filter structure averages");
  keys.number("periods",
              settings.periods,
              Range::positive(),
              "periods of the stripes that a sequence takes in equal steps; for filter phase");
}

void visit_threshold(KeyVisitor& keys, InspectionSettings& settings) {
  keys.choice("threshold",
              settings.threshold,
              kThresholds,
              "fixed: threshold_grey; noise: threshold_sigmas of the response's own scatter; "
              "false_alarms: what flawless pictures exceed false_alarms_per_picture times");
  keys.number("threshold_grey",
              settings.threshold_grey,
              Range::positive(),
              "response that makes a defect, share of full scale");
  keys.number("threshold_sigmas",
              settings.threshold_sigmas,
              Range::positive(),
              "response that makes a defect, in robust standard deviations of the response");
  keys.number("false_alarms_per_picture",
              settings.false_alarms_per_picture,
              Range::positive(),
              "blobs that a flawless picture may have on average");
  keys.choice("polarity", settings.polarity, kPolarities, "a defect relative to its background");
}

void visit_blobs(KeyVisitor& keys, InspectionSettings& settings) {
  keys.integer("erosion_px",
               settings.erosion_px,
               Range::between(0, 1000),
               "rim of the part that is not inspected");
  keys.integer(
      "min_area_px", settings.min_area_px, Range::at_least(1), "smaller blobs are no defects");
  keys.integer("max_reports",
               settings.max_reports,
               Range::between(0, 1000000),
               "reports of a part: the threshold is raised until no more are left; 0: any number");
  keys.choice(
      "kind_rule",
      settings.kind_rule,
      kKindRules,
      "what distinguishes a hole from a scratch; printed: equation 4 of the publication, which "
      "depends on the direction only");
  keys.number("hole_compactness",
              settings.hole_compactness,
              Range::between(0, 1),
              "from this compactness (1 - elongation) on a blob is a hole or bump");
  keys.number("printed_k", settings.printed_k, Range::positive(), "k of the printed rule");
  keys.integer("hole_below_px",
               settings.hole_below_px,
               Range::at_least(0),
               "blobs with fewer pixels count as holes");
  keys.choice("measure",
              settings.measure,
              kMeasureNames,
              "size of a defect in the limits of the classes: its pixels, or its weight");
}

}  // namespace

void visit_keys(KeyVisitor& keys, GradeLimits& limits) {
  keys.number("perfect_biggest",
              limits.perfect_biggest,
              Range::at_least(0),
              "biggest defect of a perfect part [px, or weight]");
  keys.number("perfect_sum",
              limits.perfect_sum,
              Range::at_least(0),
              "all defects of a perfect part together [px, or weight]");
  keys.number("acceptable_biggest",
              limits.acceptable_biggest,
              Range::at_least(0),
              "biggest defect of an acceptable part [px, or weight]");
  keys.number("acceptable_sum",
              limits.acceptable_sum,
              Range::at_least(0),
              "all defects of an acceptable part together [px, or weight]");
  keys.require(limits.acceptable_biggest >= limits.perfect_biggest,
               "acceptable_biggest",
               "must not be smaller than perfect_biggest");
  keys.require(limits.acceptable_sum >= limits.perfect_sum,
               "acceptable_sum",
               "must not be smaller than perfect_sum");
}

void visit_keys(KeyVisitor& keys, TrialSettings& settings) {
  keys.integer("parts",
               settings.parts,
               Range::between(1, 100000),
               "simulated parts with defects drawn anew, each scanned once");
  keys.integer("flawless",
               settings.flawless,
               Range::between(2, 100000),
               "simulated scans of the flawless part");
  keys.integer("noise_seeds",
               settings.noise_seeds,
               Range::between(2, 10000),
               "scans behind the interval of a score of one picture");
  keys.number("mask_grey",
              settings.mask_grey,
              Range::positive(),
              "flawless pixels whose response without noise exceeds this share of full scale are "
              "masked out; defects there count as missed");
  keys.number("confidence",
              settings.confidence,
              {.min = 0.5, .max = 0.9999, .min_excluded = true},
              "confidence of all intervals");
  keys.number("hit_radii",
              settings.hit_radii,
              Range::between(1, 100),
              "a defect is found when a blob's middle lies within that many of its radii");
  keys.number("echo_px",
              settings.echo_px,
              Range::between(0, 1000),
              "blobs that lie farther by up to this are side lobes of the defect's signature: "
              "neither hits nor false alarms");
}

void visit_keys(KeyVisitor& keys, InspectionSettings& settings) {
  visit_filter(keys, settings);
  visit_threshold(keys, settings);
  visit_blobs(keys, settings);
  keys.table(
      "holes",
      [&](KeyVisitor& table) { visit_keys(table, settings.holes); },
      "limits of the classes for holes and bumps");
  keys.table(
      "scratches",
      [&](KeyVisitor& table) { visit_keys(table, settings.scratches); },
      "limits of the classes for scratches");
  keys.table(
      "trials",
      [&](KeyVisitor& table) { visit_keys(table, settings.trials); },
      "simulated inspections behind the scores of a study");
}

InspectionSettings photograph_settings() {
  InspectionSettings settings;
  settings.filter = InspectionSettings::Filter::kStructure;
  settings.threshold_sigmas = 3.0;  // of the structure everywhere, which is more than noise
  settings.min_area_px = 10;
  settings.max_reports = 20;
  return settings;
}

}  // namespace glint
