// SPDX-License-Identifier: GPL-3.0-or-later
//
// How pictures are inspected. The way of the first seed (Seulin, Merienne, Gorria 2002, section
// 2.2) is the default: aspect image, minus its Gaussian, threshold, blobs, moments, classes.
#pragma once

#include "core/config/keys.h"

namespace glint {

/// Largest sizes of a class of defects on a part, in pixels (or in weight, see `measure`).
struct GradeLimits {
  double perfect_biggest = 0.0;     ///< >= 0; the biggest defect of a perfect part
  double perfect_sum = 0.0;         ///< >= 0; all of them together
  double acceptable_biggest = 0.0;  ///< >= perfect_biggest
  double acceptable_sum = 0.0;      ///< >= perfect_sum
};

void visit_keys(KeyVisitor& keys, GradeLimits& limits);

/// Inspecting simulated parts to see what a lighting is worth.
struct TrialSettings {
  int parts = 20;            ///< >= 1; with defects drawn anew, each scanned once
  int flawless = 32;         ///< >= 2; scans of the flawless part
  int noise_seeds = 8;       ///< >= 2; scans behind the interval of a score of one picture
  double mask_grey = 0.01;   ///< > 0; flawless pixels whose response has this size are masked out
  double confidence = 0.95;  ///< in (0.5, 1); of all intervals
  double hit_radii = 1.5;    ///< >= 1; a defect is found when a blob's middle lies that near
  double echo_px = 12.0;     ///< >= 0; farther by up to this: a side lobe of the defect's signature
};

void visit_keys(KeyVisitor& keys, TrialSettings& settings);

/// Rows of a picture that one thread works on at a time.
inline constexpr int kRowsPerBand = 16;

/// The [inspection] table of a scene.
struct InspectionSettings {
  /// What is subtracted, or what the aspect image is compared with; see masked_filter.h, phase.h,
  /// structure.h.
  enum class Filter { kGaussian, kDifferenceOfGaussians, kMatched, kPhase, kStructure };
  enum class Threshold { kFixed, kNoise, kFalseAlarms };
  enum class Polarity { kBoth, kBright, kDark };
  enum class KindRule { kElongation, kPrinted };
  enum class Measure { kArea, kWeight };

  Filter filter = Filter::kGaussian;
  int kernel_px = 9;      ///< odd, 3 to 255; of the Gaussian
  double sigma_px = 0.0;  ///< >= 0; of the Gaussian; 0: as its kernel has it in OpenCV
  std::vector<double> scales_px = {1.0, 2.0, 4.0};  ///< of the differences of Gaussians
  double template_px = 5.0;    ///< > 0; diameter (4 sigma) of the spot the matched filter looks for
  double structure_px = 16.0;  ///< > 0; width (4 sigma) of the window of the structure tensor
  double periods = 1.0;        ///< > 0; periods of the stripes that a sequence takes, for phases

  Threshold threshold = Threshold::kNoise;
  double threshold_grey = 0.02;           ///< > 0; of `fixed`, share of full scale
  double threshold_sigmas = 6.0;          ///< > 0; of `noise`, of the response's robust deviation
  double false_alarms_per_picture = 0.1;  ///< > 0; of `false_alarms`
  Polarity polarity = Polarity::kBoth;

  int erosion_px = 4;   ///< >= 0; rim of the part that is not looked at
  int min_area_px = 2;  ///< >= 1; smaller blobs are noise
  int max_reports = 0;  ///< >= 0; so many blobs of a part that stand out most; 0: all
  KindRule kind_rule = KindRule::kElongation;
  double hole_compactness = 0.5;  ///< in [0, 1]; 1 - elongation from which a blob is a hole or bump
  double printed_k = 1.0;         ///< of the printed rule
  int hole_below_px = 12;         ///< >= 0; smaller blobs count as holes

  Measure measure = Measure::kArea;
  GradeLimits holes = {};
  GradeLimits scratches = {};

  TrialSettings trials = {};
};

/// Names, ranges and cross checks of the keys.
void visit_keys(KeyVisitor& keys, InspectionSettings& settings);

/// What suits a single photograph, which is no scan: grooves, edges and reflections are not evened
/// out, so what varies along two directions is looked for, and the places that stand out most are
/// reported. docs/inspect.md
InspectionSettings photograph_settings();

}  // namespace glint
