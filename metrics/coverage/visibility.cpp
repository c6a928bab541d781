// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/coverage/visibility.h"

namespace glint {

Visibility::Visibility(std::size_t num_views, std::size_t num_points)
    : num_views_(num_views),
      num_points_(num_points),
      words_per_view_((num_points + 63) / 64),
      words_(num_views * words_per_view_) {}

}  // namespace glint
