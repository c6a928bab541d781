// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/path_tracing/path_settings.h"

namespace glint {

void visit_keys(KeyVisitor& keys, PathSettings& s) {
  constexpr int kMaxSamples = 65535;
  keys.integer("samples",
               s.samples,
               Range::between(1, kMaxSamples),
               "paths a pixel, at most; powers of two are spread best");
  keys.integer("max_reflections",
               s.max_reflections,
               Range::between(1, 64),
               "on the part before a path ends; 1 = direct light only");
  keys.integer("roulette_from",
               s.roulette_from,
               Range::between(1, 64),
               "dim paths may end at random after this many reflections");
  keys.integer("seed", s.seed, Range::at_least(0), "of the samples");
  keys.boolean(
      "light", s.has_light, "false: only masks, depth, normals, positions; costs no light");
  keys.integer("batches",
               s.batches,
               Range::between(1, 64),
               "independent pictures that the samples of a scored picture are divided into; their "
               "scatter gives the standard error of each score; 1 = none");
  if (keys.is_given("debias") || s.has_bias_taken_off) {
    keys.boolean("debias",
                 s.has_bias_taken_off,
                 "contrasts of defects (cnr, dprime, weber, peak and the like) and appearance.rms "
                 "have the bias that noise gives them taken off, from the batches; needs two or "
                 "more");
  }
  keys.require(!s.has_bias_taken_off || s.batches > 1,
               "debias",
               "needs two or more batches, render.paths.batches is 1");
  keys.number("relative_error",
              s.relative_error,
              Range::between(0, 1),
              "> 0: places stop early once their standard error is below this share of their "
              "brightness");
  keys.integer("min_samples",
               s.min_samples,
               Range::between(2, kMaxSamples),
               "before a place may stop early");
  keys.number("dark_share",
              s.dark_share,
              Range::between(0, 1),
              "places darker than this share of the picture's mean count as that bright");
  keys.integer("samples_per_pass",
               s.samples_per_pass,
               Range::between(1, kMaxSamples),
               "at most; a preview follows each pass, the first after 4 samples");
}

}  // namespace glint
