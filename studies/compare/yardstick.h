// SPDX-License-Identifier: GPL-3.0-or-later
//
// Real against real: how far photographs of one kind differ from each other, and how many times as
// far a simulated picture differs from them. By statistics of grey values and texture alone, so
// that the photographs need not show the same place.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/image/image.h"
#include "metrics/appearance/surface_texture.h"

namespace glint {

/// A picture's grey values over their mean, and its texture.
struct TextureSample {
  std::string name;
  ImageF grey;  ///< over the mean of the region
  Mask region;  ///< empty: all
  SurfaceTexture texture;
};

/// @param region   where the surface is; empty: the whole picture
/// @param texture  of the picture there
TextureSample texture_sample(std::string name,
                             const ImageF& picture,
                             const Mask& region,
                             SurfaceTexture texture);

/// Distances by which two samples are compared.
inline constexpr std::array<const char*, 4> kYardstickNames = {
    "histogram_distance", "radial_spectrum", "cooccurrence_contrast", "autocorrelation_length"};

using SampleDistances = std::array<double, kYardstickNames.size()>;

SampleDistances distances_between(const TextureSample& first, const TextureSample& second);

/// One distance: among the real pictures, and from the simulated ones to them.
struct YardstickRow {
  std::string name;
  double real = 0.0;      ///< median over pairs of real pictures
  double real_low = 0.0;  ///< quartiles of the same
  double real_high = 0.0;
  double simulated = 0.0;  ///< median over simulated and real pictures
  double multiple = 0.0;   ///< simulated over real
};

struct Yardstick {
  std::vector<YardstickRow> rows;
  double multiple = 0.0;  ///< geometric mean of the rows' multiples
  double low = 0.0;       ///< of 95 %: real pictures resampled
  double high = 0.0;
  std::size_t reals = 0;
  std::size_t pairs = 0;
  int window_px = 0;  ///< of the textures: the smallest of all samples
};

/// Textures whose windows differ in size are taken again with the smallest of all.
/// @param reals      two or more with at least one window each
/// @param simulated  alike; empty: the real pictures alone (multiples are 0)
/// @returns nothing for fewer than two real pictures, or where one picture has no window
std::optional<Yardstick> measure_yardstick(std::vector<TextureSample> reals,
                                           std::vector<TextureSample> simulated);

}  // namespace glint
