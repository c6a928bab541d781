// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/config/keys.h"

namespace glint {

/// A part of a picture.
struct PixelWindow {
  int left_px = 0;
  int top_px = 0;
  int width_px = 0;
  int height_px = 0;

  bool operator==(const PixelWindow&) const = default;
};

/// How far and how finely paths are followed: the keys of [render.paths], and what the caller adds;
/// docs/theory/path_tracing.md.
struct PathSettings {
  int samples = 64;         ///< paths a pixel, at most; > 0
  int max_reflections = 8;  ///< on the part; 1: direct light only; > 0
  int roulette_from = 3;    ///< dim paths may end at random after this many reflections
  int channels = 3;         ///< no key: 3, or 1 for a grey camera
  int seed = 1;
  bool has_light = true;  ///< false: only what the camera sees of the part, which costs no light
  /// Independent pictures that `samples` are divided into, where scores want to know their standard
  /// error; render_paths() itself makes one picture.
  int batches = 4;
  /// Whether contrasts of defects have the bias of noise taken off, from the same pictures.
  bool has_bias_taken_off = false;

  /// > 0: pixels stop early once their standard error is below this share of their brightness.
  double relative_error = 0.0;
  int min_samples = 16;       ///< before a pixel may stop
  double dark_share = 0.1;    ///< pixels darker than this share of the picture's mean count as that
  int samples_per_pass = 32;  ///< at most; the first passes are shorter: 4, 4, 8, 16, 32, 32, ...

  std::vector<PixelWindow> windows;  ///< no key: only cells that touch one are made; empty: all
};

/// The keys of [render.paths].
void visit_keys(KeyVisitor& keys, PathSettings& settings);

}  // namespace glint
