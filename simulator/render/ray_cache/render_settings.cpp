// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/ray_cache/render_settings.h"

#include <array>

namespace glint {
namespace {

constexpr std::array<std::string_view, 7> kMethodNames = {
    "auto", "sampled", "integrated", "closed", "paths", "blurred", "direct"};

}  // namespace

std::string_view method_name(RenderSettings::Method method) {
  return kMethodNames[static_cast<std::size_t>(method)];
}

void visit_keys(KeyVisitor& keys, RenderSettings& s) {
  keys.choice(
      "method",
      s.method,
      kMethodNames,
      "how pictures are rendered: auto = closed forms in a search, integrated footprints for "
      "pictures, paths where light or material need it; sampled = rays_per_axis^2 point "
      "samples a pixel; paths = path tracing; blurred = rough metal under one tunnel without the "
      "noise of paths, alpha 0.02 to 0.1; direct = rough metal in the direct light of lamps "
      "without "
      "the noise of paths, alpha from 0.05");
  keys.integer(
      "rays_per_axis",
      s.rays_per_axis,
      Range::between(1, 16),
      "sampled, blurred, direct: rays along each side of a pixel; their square is the number of "
      "rays; direct: at most 4, and the sum is as much more exact");
  keys.number(
      "max_direction_error_mrad",
      s.max_direction_error_rad,
      Range::between(1e-3, 100),
      "not sampled, blurred or direct: largest error of reflected rays interpolated linearly "
      "across a cell of a "
      "pixel; smaller = more cells where the surface is curved");
  keys.integer("max_bounces",
               s.max_bounces,
               Range::between(1, 64),
               "reflections on the part before a ray is given up as dark (and counted)");
}

}  // namespace glint
