// SPDX-License-Identifier: GPL-3.0-or-later
//
// By what a folder's pictures are told from those of another plan, cell, prototype or power.
#pragma once

#include <filesystem>
#include <string>

#include "studies/acquire/acquire_plan.h"

namespace glint {

/// Of everything that decides which pictures are taken: tour, lights, exposures, camera, scan, and
/// of a scene how its lights are built and, of those that shine, at which power. @return SHA-256
std::string plan_digest(const AcquireWork& work, const AcquireSource& source, const Cell& cell);

/// Under which digest pictures in a folder count as those of this work. It is plan_digest(), but
/// for a folder that an earlier program began, whose digest knew no powers: that one's, where the
/// scene that lies in the folder has its lights at the same powers and the folder has seen one
/// session: a later one wrote its own scene there, whether or not it took a picture.
std::string digest_in(const std::filesystem::path& folder,
                      const AcquireWork& work,
                      const AcquireSource& source,
                      const Cell& cell);

}  // namespace glint
