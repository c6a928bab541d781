// SPDX-License-Identifier: GPL-3.0-or-later
//
// Some rows of the picture are traced and refined for themselves, and tell how many rays the whole
// would have. Each is a window of three rows, since a pixel is judged by its neighbours, too. Cost:
// 48 rows of corner rays, 12 where few pixels are bent, and only for parts with triangles enough to
// bend that many pixels; memory of one row.
#include "simulator/render/corner_rays/affordable_cells.h"

#include <algorithm>
#include <array>
#include <functional>

#include "simulator/render/corner_rays/corner_tracer.h"
#include "simulator/render/corner_rays/planned_rays.h"

namespace glint {
namespace {

/// Without 8, at which broken pixels end as well: see max_cells_of().
constexpr std::array kChoices = {16, 4, 2};

constexpr int kRowsOfWindow = 3;
constexpr int kMaxRows = 16;
constexpr int kRowStep = 8;

/// First, rows this many times further apart are counted: where they need far fewer rays than
/// allowed, no more are.
constexpr int kGlance = 4;

/// Fewer triangles without an exact surface have edges too short to bend that many pixels.
constexpr std::size_t kFewTriangles = 2000;

bool has_many_free_triangles(const Part& part) {
  const TriangleMesh& mesh = part.mesh;
  const std::size_t in_patches =
      part.patches.empty() ? 0
                           : static_cast<std::size_t>(std::ranges::count_if(
                                 mesh.patch, [](std::int32_t patch) { return patch >= 0; }));
  return mesh.triangles.size() - in_patches >= kFewTriangles;
}

/// Refined pixels by number of cells.
using PixelCounts = std::array<std::int64_t, kCellCounts.size()>;

/// The camera that sees rows y - 1 to y + 1 of the picture, pixel by pixel the same.
PinholeIntrinsics window_around(PinholeIntrinsics intrinsics, int y) {
  intrinsics.height_px = kRowsOfWindow;
  intrinsics.center_px.y() -= y - 1;
  return intrinsics;
}

/// Refined pixels of row y.
PixelCounts count_row(const TraceScene& scene,
                      const RefinementNeed& need,
                      const PlacedCamera& placed,
                      int y) {
  const PlacedCamera window = {PinholeCamera(window_around(placed.camera.intrinsics(), y)),
                               placed.camera_from_world};
  const CameraRays rays(window.camera, window.camera_from_world);
  const RefinementNeed vertices = need.vertices_in(y - 1, kRowsOfWindow);
  const UpdatePlan everything;
  CornerRays seen = empty_corner_rays(window);
  CornerTracer tracer(scene, rays, vertices, everything, nullptr, kChoices.front(), seen);
  for (int row = 0; row <= kRowsOfWindow; ++row) {
    tracer.trace_corners(row);
  }
  const RowGroups groups = tracer.refine(1).groups;
  PixelCounts counts = {};
  std::ranges::transform(groups, counts.begin(), [](const RowGroup& group) {
    return static_cast<std::int64_t>(group.group.pixels.size());
  });
  return counts;
}

/// Rays of these pixels when none has more than max_cells cells along each side.
std::int64_t rays_of(const PixelCounts& counts, int max_cells) {
  std::int64_t rays = 0;
  for (std::size_t k = 0; k < counts.size(); ++k) {
    rays += counts[k] * static_cast<std::int64_t>(corners_of(std::min(kCellCounts[k], max_cells)));
  }
  return rays;
}

/// Refined pixels of a sample of rows, from which those of the picture are estimated.
class SampledRows {
 public:
  SampledRows(const TraceScene& scene, const RefinementNeed& need, const PlacedCamera& placed)
      : scene_(scene), need_(need), placed_(placed) {}

  /// Counts the refined pixels of every step-th row.
  void take(int step, ThreadPool& pool) {
    const int height = placed_.camera.intrinsics().height_px;
    rows_ = std::max(1, height / step);
    counts_ = {};
    for (const PixelCounts& row : pool.map<PixelCounts>(rows_, [&](std::int64_t i) {
           const int y = std::clamp(static_cast<int>(i) * step + step / 2, 1, height - 2);
           return count_row(scene_, need_, placed_, y);
         })) {
      std::ranges::transform(counts_, row, counts_.begin(), std::plus<>());
    }
  }

  /// Whether the picture is estimated to need at most max_rays rays when no pixel has more than
  /// `cells` cells along each side.
  bool are_within(std::int64_t max_rays, int cells) const {
    return rays_of(counts_, cells) * placed_.camera.intrinsics().height_px <= max_rays * rows_;
  }

 private:
  const TraceScene& scene_;
  const RefinementNeed& need_;
  const PlacedCamera& placed_;
  int rows_ = 0;
  PixelCounts counts_ = {};
};

}  // namespace

int affordable_cells(const Part& part,
                     const Bvh& bvh,
                     const PlacedCamera& placed,
                     const RefinementNeed& need,
                     const RenderSettings& settings,
                     ThreadPool& pool,
                     std::int64_t max_rays) {
  const PinholeIntrinsics& in = placed.camera.intrinsics();
  const std::int64_t row_rays =
      in.width_px * static_cast<std::int64_t>(corners_of(kChoices.front()));
  if (row_rays * in.height_px <= max_rays || in.height_px < kRowsOfWindow ||
      !has_many_free_triangles(part)) {
    return kChoices.front();
  }
  const SurfaceDetail none;
  const TraceScene scene(part, bvh, none, settings);
  SampledRows sampled(scene, need, placed);
  const int step = std::max(kRowStep, in.height_px / kMaxRows);
  const int wide_step = kGlance * step;
  if (row_rays * wide_step <= max_rays) {  // what lies between the rows cannot be too much
    sampled.take(wide_step, pool);
    if (sampled.are_within(max_rays / kGlance, kChoices.front())) {
      return kChoices.front();
    }
  }
  sampled.take(step, pool);
  const auto affordable = std::ranges::find_if(
      kChoices, [&](int cells) { return sampled.are_within(max_rays, cells); });
  return affordable != kChoices.end() ? *affordable : kChoices.back();
}

int max_cells_of(const CornerRays& rays) {
  for (const RefinedGroup& group : rays.refined) {
    if (group.cells_per_axis < kCellsOfBroken &&
        std::ranges::find(group.is_smooth, 0) != group.is_smooth.end()) {
      return group.cells_per_axis;
    }
  }
  return kChoices.front();
}

}  // namespace glint
