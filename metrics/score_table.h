// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "metrics/scores.h"

namespace glint {

/// The rows of score_docs(), with their placeholders.
std::span<const ScoreDoc> score_table();

}  // namespace glint
