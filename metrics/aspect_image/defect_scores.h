// SPDX-License-Identifier: GPL-3.0-or-later
//
// How well each defect stands out from the surface around it. D: the defect's pixels (distance
// <= 1 radius), B: its background ring (2 to 5 radii, on the part, away from other defects), W: the
// window of 2 radii that holds the whole signature. Formulas and choices:
// docs/theory/visibility.md.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/error.h"
#include "metrics/aspect_image/roi.h"

namespace glint {

/// Which pixels of an image belong to one defect; indices into Image::values().
struct DefectPixels {
  std::string label;
  std::vector<std::size_t> inside;  ///< D: at distance <= 1, at least the nearest pixel
  std::vector<std::size_t> ring;    ///< B: not empty
  std::vector<std::size_t> window;  ///< W: within the inner radius of the ring, on the part
  double area_px = 0.0;
};

/// The table of a scene that a defect comes from: "defects.dent" for the label "dent_2".
std::string defect_table(const std::string& label);

/// The error for a defect that cannot be scored, at its table, with what to do about it.
/// @param why  "is not in the picture"
ConfigError unseen_defect(const std::string& label, const std::string& why);

/// Sorts the pixels around each defect; once for a fixed part and camera.
/// @param on_part  pixels wholly on the part (whole_pixels), with or without its rim
/// @throws ConfigError naming the defect that has no pixel or no background on the part
std::vector<DefectPixels> defect_pixels(std::span<const DefectView> defects,
                                        const Mask& on_part,
                                        const MetricsSettings& settings = {});

/// 0 of no pixel.
double mean_of(const ImageF& image, const std::vector<std::size_t>& pixels);

/// Scores of one defect in one image.
struct DefectScores {
  std::string label;
  double weber = 0.0;         ///< (mean_D - mean_B) / mean_B; signed
  double michelson = 0.0;     ///< (max - min) / (max + min) over W; in [0, 1]
  double cnr = 0.0;           ///< |mean_D - mean_B| / sigma_B
  double peak = 0.0;          ///< (f - mean_B) / mean_B where |f - mean_B| is largest in D; signed
  double dprime = 0.0;        ///< sqrt(max(0, sum_W (f - mean_B)^2 - |W| s_B^2)) / sigma_B
  double signature = 0.0;     ///< pixels of W far from mean_B, over the true area
  double rms_contrast = 0.0;  ///< standard deviation over D and B together, over their mean
  // Of single frames, from BestFrames:
  double best_frame = 0.0;  ///< largest |mean_D - mean_B|, share of full scale
  double change = 0.0;      ///< largest mean_D |f - flawless f|, share of full scale
  double union_area = 0.0;  ///< pixels of D that change in any frame, over the true area
  int frame = -1;           ///< the one with the largest |mean_D - mean_B|; -1: none
  int change_frame = -1;    ///< the one with the largest change; -1: none
};

/// Scores every defect.
///
/// s_B is the ring's standard deviation, sigma_B = max(s_B, sigma_floor), and mean_B stands in a
/// denominator as max(mean_B, sigma_floor): a perfectly even or black background divides by what
/// the sensor cannot resolve anyway.
///
/// @param sigma_floor  > 0; noise_floor() of the sensor or the step of one grey level / sqrt(12)
std::vector<DefectScores> defect_scores(const ImageF& image,
                                        std::span<const DefectPixels> defects,
                                        double sigma_floor,
                                        const MetricsSettings& settings = {});

/// The worst and the average defect: a lighting is as good as what it hides.
struct DefectSummary {
  double min_cnr = 0.0;
  double min_weber = 0.0;   ///< of |weber|
  double mean_weber = 0.0;  ///< of |weber|
  double min_dprime = 0.0;
  double min_signature = 0.0;
  double min_change = 0.0;
  double mean_change = 0.0;
  double min_rms_contrast = 0.0;
  double min_best_frame = 0.0;
  double min_union = 0.0;
};

/// Empty for no defects.
DefectSummary summarise(std::span<const DefectScores> scores);

/// Watches the frames of a scan go by and keeps, for each defect, the frame that shows it best:
/// what an inspection of single frames could use, and what the mean of the scan may wash out. Under
/// stripes the difference from the ring holds the stripes too; the change against the flawless
/// surface does not. With stripes of full contrast the change is the share of D that has flipped.
class BestFrames {
 public:
  /// @param defects       must outlive this object
  /// @param mean_floor    > 0; denominator of the contrast where the background is darker
  /// @param change_threshold  > 0; of a pixel in one frame, share of full scale; below it is noise
  explicit BestFrames(std::span<const DefectPixels> defects,
                      double mean_floor = 0.01,
                      double change_threshold = 0.02);

  /// Frames in scan order.
  /// @param flawless  for each defect the values its own pixels (DefectPixels::inside, in their
  ///                  order) would have without it; empty: not known, the change stays 0
  void add(const ImageF& frame, std::span<const std::vector<float>> flawless = {});

  struct Best {
    double weber = 0.0;       ///< largest |mean_D - mean_B| / max(mean_B, mean_floor) of any frame
    double difference = 0.0;  ///< largest |mean_D - mean_B| of any frame, share of full scale
    int frame = -1;           ///< the first frame with that difference; -1: no frame yet
    double change = 0.0;      ///< largest mean over D of |f - flawless f| of any frame
    int change_frame = -1;    ///< the first frame with that change; -1: no frame changes
    double union_area = 0.0;  ///< pixels of D that changed in any frame yet, over the true area
  };

  /// One for each defect, in their order.
  const std::vector<Best>& best() const { return best_; }

 private:
  std::span<const DefectPixels> defects_;
  double mean_floor_;
  double change_threshold_;
  int frames_ = 0;
  std::vector<std::vector<bool>> has_changed_;  ///< for each defect, of its own pixels
  std::vector<Best> best_;
};

}  // namespace glint
