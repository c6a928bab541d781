// SPDX-License-Identifier: GPL-3.0-or-later
//
// One method of rendering on the frontier with its cost and its errors, and what follows from
// errors alone: which methods nothing cheaper undercuts, how wrong the reference itself is.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/image/image.h"
#include "studies/definition/ladder/compared_methods.h"

namespace glint {

/// Errors of one defect against the reference; in per cent of the reference's value, or of 1 % of
/// full contrast where that is less.
struct DefectErrors {
  double weber_percent = 0.0;   ///< of its contrast in the aspect image
  double change_percent = 0.0;  ///< of its change of the best single frame
};

/// One score of a method against the reference's.
struct ScoreError {
  double value = 0.0;   ///< mean over the method's pictures
  double error = 0.0;   ///< rms distance of one of them from the reference, less its own noise
  double spread = 0.0;  ///< standard deviation over the pictures; 0 for one
};

/// One method on the chart.
struct FrontierPoint {
  ComparedMethod method;
  std::string label;         ///< unique; "4 rays a pixel", "integrated, 2 mrad, half resolution"
  int reduction = 1;         ///< 2: half as many pixels of twice the size along both sides
  std::string tessellation;  ///< "exact surface", "mesh file", "facets 20 um"
  std::string realisation;   ///< of all defects: "normal", "displaced", ...; empty: the scene's own
  int pictures = 1;          ///< with random numbers of their own, that errors are the rms of
  std::int64_t rays = 0;     ///< that one picture by paths traced; counted, not timed
  double cpu_s = 0.0;        ///< one warm candidate, one thread
  double traced_per_px = 0.0;  ///< rays from the camera over pixels, as traced
  std::string form;            ///< how the mean of the scan came about: form_name()
  int frame_pixels = 0;        ///< that were rendered frame by frame for it
  double cold_s = 0.0;         ///< the first candidate: part built, rays traced, all threads' sum
  std::optional<double> frame_rmse;  ///< of radiance, full scale 1; absent without frames
  /// The same without edges of the light, rim of the part and defects.
  std::optional<double> smooth_frame_rmse;
  double h_error_points = 0.0;  ///< of homogeneity.h_rms, in hundredths
  std::map<std::string, DefectErrors> defects;
  std::map<std::string, ScoreError> scores;  ///< all that the reference has too
  std::vector<std::string> on_front;         ///< names of the errors that nothing cheaper undercuts
  bool is_reference = false;                 ///< its errors are 0 by definition
  bool is_chosen = false;                    ///< of paths: mark_choice()
  std::string problem;                       ///< why it could not be measured; empty: it was

  /// The worst error of any defect; absent without defects.
  std::optional<double> contrast_error_percent() const;
};

/// Names of the errors: those of the charts and of FrontierPoint::on_front.
inline constexpr const char* kFrameRmse = "frame_rmse";
inline constexpr const char* kHError = "h_error_points";
inline constexpr const char* kContrastError = "contrast_error_percent";

/// An error of a point by its name; absent where it has none.
std::optional<double> error_of(const FrontierPoint& point, const std::string& name);

/// Sets on_front of all points: an error belongs to the front when no point that is not slower
/// has a smaller one; errors as small as rounding count as equal. The reference takes no part.
void mark_front(std::vector<FrontierPoint>& points);

/// How wrong the reference's own frames are, from its distance to frames with 16 and 64 rays: their
/// errors are taken as independent and as falling by the same factor k from 16 to 64 to 256 rays,
/// so rmse_16^2 = (1 + k^4) own^2 and rmse_64^2 = (1 + k^2) own^2. Absent when the first is no
/// larger.
std::optional<double> own_frame_rmse(double rmse_16, double rmse_64);

/// Root of a mean square without the share of it that is another's noise; 0 where that is all of
/// it.
double rms_less_noise(double mean_square, double noise_square);

/// A picture of half resolution at full resolution, linear between the centres of its pixels.
ImageF enlarged(const ImageF& half, int width_px, int height_px);

}  // namespace glint
