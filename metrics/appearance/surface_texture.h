// SPDX-License-Identifier: GPL-3.0-or-later
//
// Statistics of a texture, for surfaces that agree in their statistics alone, and how far two of
// them are apart. docs/theory/comparison.md has formulas and sources.
#pragma once

#include <vector>

#include "core/image/image.h"

namespace glint {

/// Windows of a texture's statistics.
struct TextureWindows {
  int window_px = 256;   ///< >= 16, a power of two; halved until windows fit into the region
  int max_windows = 32;  ///< taken evenly from all that fit, >= 1: more hardly sharpen a spectrum
  int grey_levels = 32;  ///< of the co-occurrence matrix, in [2, 256]
};

/// Co-occurrence of grey values (R. Haralick et al., "Textural features for image classification",
/// IEEE Trans. SMC 3(6), 1973), symmetric, mean over the lags (1, 0), (0, 1), (1, 1) and (1, -1).
struct Cooccurrence {
  double contrast = 0.0;  ///< mean squared difference in levels
  double correlation = 0.0;
  double energy = 0.0;
  double entropy = 0.0;  ///< in bits
};

struct SurfaceTexture {
  int windows = 0;  ///< that were taken, overlapping by half; 0: the region holds none
  int window_px = 0;
  /// Power spectral density of grey over its mean, mean over angles, by cycles per pixel
  /// (i + 0.5) / window_px; in px^2.
  std::vector<double> radial;
  /// Share of the power between 0.02 and 0.4 cycles per pixel in 36 directions of the wave vector,
  /// from 0 to 180 degrees (+x to +y).
  std::vector<double> angular;
  double autocorrelation_px = 0.0;  ///< where it has fallen to 0.2 along its shortest direction
  double longest_px = 0.0;          ///< along its longest direction; at most window_px / 2
  /// Direction along which the surface changes least, in [0, pi), and how clear it is: 0 alike in
  /// all directions, 1 parallel lines.
  double lay_rad = 0.0;
  double lay_strength = 0.0;
  double spread = 0.0;  ///< standard deviation of grey over its mean, in the windows
  Cooccurrence cooccurrence;
};

/// @param region  windows lie wholly in it; empty: the whole picture
SurfaceTexture texture_of(const ImageF& picture,
                          const Mask& region = {},
                          const TextureWindows& settings = {});

/// How far two textures are apart.
struct TextureDistance {
  double radial = 0.0;    ///< rms of the log10 ratio of radial spectra, 0.02 to 0.4 cycles per px
  double angular = 0.0;   ///< half the sum of absolute differences, in [0, 1]
  double contrast = 0.0;  ///< |ln| of the ratio of co-occurrence contrasts
  double length = 0.0;    ///< |ln| of the ratio of autocorrelation lengths
  double lay_rad = 0.0;   ///< between both lays, in [0, pi/2]
};

/// @param first, second  with at least one window each, of the same size
TextureDistance distance_between(const SurfaceTexture& first, const SurfaceTexture& second);

}  // namespace glint
