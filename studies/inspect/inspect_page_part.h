// SPDX-License-Identifier: GPL-3.0-or-later
//
// The section of one part on the page of `glint inspect`.
#pragma once

#include <cstddef>
#include <string>

#include "studies/inspect/inspect_page.h"
#include "studies/inspect/inspected_part.h"

namespace glint::inspect_html {

/// One part: picture with its marks, list of defects, histogram.
/// @param index  from 1, for links
std::string part_section(const InspectedPart& part, const PagePicture& picture, std::size_t index);

}  // namespace glint::inspect_html
