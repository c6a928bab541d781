// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "simulator/render/corner_rays/cell_rule.h"
#include "simulator/render/corner_rays/classified_rays.h"
#include "simulator/render/corner_rays/detail_reach.h"
#include "simulator/render/corner_rays/refined_groups.h"
#include "simulator/render/corner_rays/refinement_rule.h"
#include "simulator/render/corner_rays/update_plan.h"
#include "simulator/render/ray_cache/packet_tracer.h"

namespace glint {

/// A pixel on its way to enough cells.
struct Candidate {
  int x = 0;
  int cells = 0;
  bool is_examined = false;  ///< described by its corners unless a defect hides between them
};

/// What came of one row.
struct CornerRow {
  RayCounts counts;         ///< of the kept rays
  std::int64_t traced = 0;  ///< rays that were really traced
  RowGroups groups;
};

/// Traces, classifies and refines; rows are independent of each other. All corners must be traced
/// before the first row is refined.
class CornerTracer {
 public:
  /// @param base  rays without detail, from which everything is taken that the plan leaves out;
  ///              nullptr: everything is traced
  /// @param max_cells  of pixels beyond the reach of height features
  CornerTracer(const TraceScene& scene,
               const CameraRays& camera,
               const RefinementNeed& need,
               const UpdatePlan& plan,
               const CornerRays* base,
               int max_cells,
               CornerRays& result);

  CornerRow trace_corners(int y);
  CornerRow refine(int y);

  /// Moves the corners to the result.
  void finish();

 private:
  RayGrid corner_grid() const;
  void copy_corner(std::size_t i, RayCounts& counts);
  void copy_pixels(int y, CornerRow& row);
  int max_cells(int x, int y) const;
  void classify(int x, int y, std::vector<Candidate>& open);
  void set_smooth(int x, int y);
  void trace_batch(const std::vector<Candidate>& pixels, int y, SubCorners& batch) const;
  std::vector<Candidate> refine_once(const std::vector<Candidate>& open, int y, CornerRow& row);
  void refine_batch(const std::vector<Candidate>& pixels,
                    int y,
                    CornerRow& row,
                    std::vector<Candidate>& more);
  void keep(const SubCorners& batch,
            std::size_t first,
            const Candidate& pixel,
            int y,
            const CheckedCells& cells,
            CornerRow& row);
  bool set_coverage(const SubCorners& batch, std::size_t first, int n, int x, int y);

  int max_cells_ = 0;
  double kink_factor_ = 1.0;
  const TraceScene& scene_;
  const CameraRays& camera_;
  ImageArea area_;  ///< outside of which no ray meets the part
  const RefinementNeed& need_;
  const UpdatePlan& plan_;
  const CornerRays* base_;
  CornerRays& result_;
  Classified corners_;
};

}  // namespace glint
