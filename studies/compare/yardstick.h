// SPDX-License-Identifier: GPL-3.0-or-later
//
// Real against real: how far photographs of one kind differ from each other, and how many times as
// far a simulated picture differs from them. By statistics of grey values and texture alone, so
// that the photographs need not show the same place.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/image/image.h"
#include "metrics/appearance/surface_texture.h"

namespace glint {

struct ComparedPair;

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

/// The pictures of a comparison, each file once.
class YardstickPictures {
 public:
  void add(const ComparedPair& pair);

  /// Where one simulated picture was compared with two photographs or more: copies of a photograph
  /// differ from it by nothing and do not count.
  std::optional<Yardstick> measure() const;

  /// Which photographs do not count, and why there is no yardstick of two or more.
  std::vector<std::string> notes() const;

 private:
  /// Only where photographs are of one kind: compared with the same simulated picture.
  bool has_yardstick() const { return simulated_.size() == 1 && reals_.size() >= 2; }

  /// Those that are equal to an earlier one in the order of their paths, or all others.
  std::vector<const TextureSample*> photographs(bool is_copy) const;
  std::string without_windows() const;

  std::map<std::string, TextureSample> simulated_;  ///< by path
  std::map<std::string, TextureSample> reals_;
};

}  // namespace glint
