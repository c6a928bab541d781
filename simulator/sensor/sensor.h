// SPDX-License-Identifier: GPL-3.0-or-later
//
// From scene-linear radiance to the grey values a camera would record:
//
//     radiance L >= 0 -> Gaussian blur -> x exposure -> shot noise -> + read noise -> x gain
//                     -> clip to [0, 1] -> quantisation -> linear grey value in [0, 1]
//
// Full scale is the value 1; L = 1 reaches it at exposure 1 and gain 1. With full_well_e = F the
// pixel collects F exposure L + dark_e electrons on average, one electron is worth K = gain / F,
// and F / gain electrons are full scale. Without F the sensor is free of noise.
// Not modelled: fixed pattern (DSNU, PRNU), blooming, non-linear response, black level.
// Source: EMVA Standard 1288, linear model; docs/theory/sensor.md.
#pragma once

#include <cstdint>
#include <vector>

#include "core/config/keys.h"
#include "core/image/image.h"
#include "core/image/spans.h"

namespace glint {

/// The [sensor] table of a scene.
struct SensorSettings {
  double exposure = 1.0;      ///< > 0; factor of the radiance
  double gain = 1.0;          ///< > 0; factor of the signal
  double blur_px = 0.7;       ///< >= 0; sigma of the Gaussian blur (blur_kernel.h), 0: none
  int bits = 8;               ///< 8, 10, 12 or 16; 0: no quantisation
  double full_well_e = 0.0;   ///< >= 0; electrons at full scale and gain 1, 0: no noise
  double read_noise_e = 0.0;  ///< >= 0; standard deviation, needs full_well_e
  double dark_e = 0.0;        ///< >= 0; mean dark signal of one frame, needs full_well_e
  int seed = 1;               ///< >= 0; of the noise
  std::vector<double> wavelengths_nm = {550.0};  ///< of its channels: 1 (grey) or 3 (R, G, B)
};

/// Names, ranges and cross checks of the keys.
void visit_keys(KeyVisitor& keys, SensorSettings& settings);

/// Standard deviation of a frame's grey value that no light causes: quantisation (one step /
/// sqrt(12)) and read noise, added in squares; 0 for a perfect sensor.
double noise_floor(const SensorSettings& settings);

/// What a scan leaves behind: enough for the aspect image and for where it is saturated.
struct ScanSums {
  /// Of the grey values over the frames. In double: of an even picture float would round away what
  /// h is made of.
  Image<double> sum;
  Image<std::uint16_t> clipped_frames;  ///< frames in which the pixel is at full scale
  int frames = 0;

  ScanSums() = default;

  ScanSums(int width_px, int height_px)
      : sum(width_px, height_px), clipped_frames(width_px, height_px) {}

  /// The mean of the frames, height x width. Needs at least one frame.
  ImageF aspect() const;
};

/// The same sensor without shot, read and dark noise.
SensorSettings without_noise(SensorSettings settings);

/// Mean grey value that the dark signal adds.
double dark_grey(const SensorSettings& settings);

/// Exposes frames. Immutable; may be shared between threads.
class Sensor {
 public:
  /// @throws ConfigError for an empty image.
  Sensor(const SensorSettings& settings, int width_px, int height_px);

  /// One frame. The noise depends on (seed, frame_index, pixel) alone: frames may be exposed in
  /// any order. Pixels beyond the border count as the border's nearest pixel.
  /// @param radiance  height x width, scene-linear, >= 0
  /// @param frame     grey values in [0, 1]; resized when it has another size
  void expose(const ImageF& radiance, int frame_index, ImageF& frame) const;

  /// The same for some pixels only: equal bytes there, all others are left alone. The radiance must
  /// be known up to blur_radius_px() around them, and the frame have the picture's size.
  void expose(const ImageF& radiance, int frame_index, const Spans& where, ImageF& frame) const;

  /// The same frame, added to the sums in one sweep over memory; also kept when `frame` is given.
  /// Sums of no frames are started anew, whatever they hold. They are in double, which hardly ever
  /// rounds: for the same bytes add frames in the same order all the same.
  void accumulate(const ImageF& radiance,
                  int frame_index,
                  ScanSums& sums,
                  ImageF* frame = nullptr) const;

  /// The same for some pixels only: equal bytes there, all others are left alone. The radiance must
  /// be known up to blur_radius_px() around them.
  void accumulate(const ImageF& radiance,
                  int frame_index,
                  const Spans& where,
                  ScanSums& sums,
                  ImageF* frame = nullptr) const;

  /// Of the blur's centre and one side.
  const std::vector<float>& blur_weights() const { return weights_; }

  /// How far a pixel's light spreads.
  int blur_radius_px() const { return static_cast<int>(weights_.size()) - 1; }

  /// The distance beyond which less than `tail` of the light spreads to one side.
  int blur_reach_px(double tail) const;

  /// Variance of the blur along one axis [px^2], as it is: cut and sampled.
  double blur_variance_px2() const;

  /// Whether the blur would make less than none of light beside an edge, and is cut off there
  /// (blur_kernel.h).
  bool blur_is_cut_off() const { return has_negative_weights_; }

  const SensorSettings& settings() const { return settings_; }

 private:
  struct Scratch;

  template <class Consume>
  void for_each_span(const ImageF& radiance,
                     int frame_index,
                     const Spans& where,
                     ImageF* frame,
                     const Consume& consume) const;
  void blur_span(const ImageF& radiance, const RowSpan& span, Scratch& scratch) const;
  void add_noise(const RowSpan& span, int frame_index, Scratch& scratch) const;

  SensorSettings settings_;
  int width_px_ = 0;
  int height_px_ = 0;
  Spans whole_;
  std::vector<float> weights_;  ///< of the blur's centre and one side; both sides sum to 1
  bool has_negative_weights_ = false;
};

}  // namespace glint
