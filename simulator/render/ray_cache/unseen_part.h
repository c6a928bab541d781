// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/error.h"

namespace glint {

/// No camera ray meets the part. An error where a design is to be scored; a camera that really
/// stands there shows darkness.
class UnseenPart : public ConfigError {
 public:
  UnseenPart()
      : ConfigError("camera",
                    "the part is outside the image: no camera ray hits it; check viewpoint, "
                    "working_distance_mm and part.position_mm") {}
};

}  // namespace glint
