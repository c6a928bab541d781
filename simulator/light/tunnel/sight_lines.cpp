// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/tunnel/sight_lines.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace glint {
namespace {

using Eigen::Vector3d;

/// Sight lines that are looked at together: their arrays stay in the first cache.
constexpr int kSightLines = 512;

/// Some sight lines from points to the camera and where they cross the wall; t = 1 at the camera.
struct Sight {
  std::array<float, kSightLines> to_x, to_y, to_z, t, x_mm;
};

/// @param points  no more than kSightLines
void look(const Tunnel& tunnel,
          const RayBlock& points,
          const Vector3d& camera_mm,
          Sight& s,
          float* occluded) {
  aim_at(points,
         static_cast<float>(camera_mm.x()),
         static_cast<float>(camera_mm.y()),
         static_cast<float>(camera_mm.z()),
         s.to_x.data(),
         s.to_y.data(),
         s.to_z.data());
  RayBlock sight = points;
  sight.direction_x = s.to_x.data();
  sight.direction_y = s.to_y.data();
  sight.direction_z = s.to_z.data();
  tunnel.cross_wall(sight, s.t.data(), s.x_mm.data(), occluded);
  keep_sight(s.t.data(),
             s.x_mm.data(),
             points.count,
             static_cast<float>(0.5 * tunnel.settings().length_mm),
             occluded);
}

/// @param first  of the block among the lines
void set_crossing(const Tunnel& tunnel,
                  const RayBlock& points,
                  const Sight& sight,
                  int index,
                  int first,
                  SightLines& lines) {
  const auto i = static_cast<std::size_t>(index);
  if (sight.t[i] >= kNoHit_mm) {
    return;
  }
  const auto t = static_cast<double>(sight.t[i]);
  const Vector3d to = vector_of(sight.to_x[i], sight.to_y[i], sight.to_z[i]);
  const Vector3d at =
      vector_of(points.origin_x[i], points.origin_y[i], points.origin_z[i]) + t * to;
  const double to_end = std::abs(0.5 * tunnel.settings().length_mm - std::abs(at.x()));
  const double to_camera = std::abs(1.0 - t) * to.norm();
  const double to_edge = tunnel.to_edge_mm(at.tail<2>());
  const std::size_t place = static_cast<std::size_t>(first) + i;
  lines.x_mm[place] = static_cast<float>(at.x());
  lines.y_mm[place] = static_cast<float>(at.y());
  lines.z_mm[place] = static_cast<float>(at.z());
  lines.to_end_mm[place] = static_cast<float>(std::min(to_end, to_camera));
  lines.to_edge_mm[place] = static_cast<float>(std::min(to_edge, to_camera));
}

}  // namespace

SightLines sight_lines(const Tunnel& tunnel, const RayBlock& points, const Vector3d& camera_mm) {
  const auto count = static_cast<std::size_t>(points.count);
  SightLines lines;
  lines.occluded.resize(count);
  for (auto* array : {&lines.x_mm, &lines.y_mm, &lines.z_mm, &lines.to_end_mm, &lines.to_edge_mm}) {
    array->assign(count, kNoHitMargin_mm);
  }
  Sight sight;
  for (int begin = 0; begin < points.count; begin += kSightLines) {
    const RayBlock part = part_of(points, begin, kSightLines);
    look(tunnel, part, camera_mm, sight, lines.occluded.data() + begin);
    for (int i = 0; i < part.count; ++i) {
      set_crossing(tunnel, part, sight, i, begin, lines);
    }
  }
  return lines;
}

}  // namespace glint
