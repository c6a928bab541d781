// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "simulator/render/physical/cell_sums.h"
#include "simulator/render/physical/path_task.h"
#include "simulator/render/physical/ray_batch.h"
#include "simulator/render/physical/sobol.h"

namespace glint {

/// Follows the paths of one cell at a time; one tracer a thread.
///
/// All paths of a batch take each step together: camera rays, then at every reflection the rays to
/// lights and the reflected ones, each list packed without gaps. Results depend on the cell and the
/// samples alone.
class CellTracer {
 public:
  explicit CellTracer(const PathTask& task);

  /// Adds samples [first, first + count) of all pixels of a cell.
  void trace(const Cell& cell, int first, int count, PathSums& sums);

  const PathCounts& counts() const { return counts_; }

 private:
  struct Path {
    Ray ray;
    Hit hit;
    Colour weight = Colour::Ones();
    double density = 0.0;  ///< with which the ray was chosen; 0: by a mirror or the camera
    SampleNumbers numbers;
    CellPixel pixel = 0;
    double total = 0.0;
  };

  /// Light that arrives if nothing stands in its way.
  struct Pending {
    std::uint32_t path = 0;
    int group = 0;
    Colour radiance = Colour::Zero();
  };

  void start(const Cell& cell, int first, int count);
  void start_pixel(const Cell& cell, int x, int y, int first, int count);
  void look_at_part();
  void look_at_lights(bool is_camera);
  void reflect_all(int reflection);
  bool reflect(std::uint32_t index, int reflection);
  void ask_light(std::uint32_t index,
                 const ShadingPoint& point,
                 const Material& material,
                 const std::array<double, 2>& random);
  bool leave(Path& path,
             const ShadingPoint& point,
             const Material& material,
             int reflection,
             const std::array<double, 2>& lobe);
  void trace_shadows();
  void trace_bounces();
  void add_light(Path& path, int group, const Colour& radiance);

  const PathTask& task_;
  CellSums cell_sums_;
  std::vector<Path> paths_;
  std::vector<ShadingPoint> points_;  ///< where each path met the part last
  std::vector<std::uint32_t> active_;
  std::vector<Pending> pending_;
  RayBatch rays_;
  RayBatch shadows_;
  PathCounts counts_;
};

}  // namespace glint
