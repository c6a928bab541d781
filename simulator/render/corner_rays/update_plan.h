// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulator/render/corner_rays/corner_rays.h"
#include "simulator/render/corner_rays/detail_reach.h"

namespace glint {

/// Which rays must be traced again when height features are added to a part: those within the
/// projected reach of a feature, and those that met the part more than once or graze it, because
/// they may meet a feature anywhere.
class UpdatePlan {
 public:
  /// Everything.
  UpdatePlan() = default;
  UpdatePlan(const CornerRays& without_detail, const RefinementNeed& need);

  /// A pixel whose kind or sub-corners may change.
  bool has_pixel(int x, int y) const { return pixels_.empty() || pixels_(x, y) != 0; }

  /// A corner that may change or is needed to classify such a pixel.
  bool has_corner(int x, int y) const { return corners_.empty() || corners_(x, y) != 0; }

 private:
  Mask pixels_;
  Mask corners_;
};

}  // namespace glint
