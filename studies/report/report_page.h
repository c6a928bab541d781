// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace glint {

/// The report page without its data: HTML, style and script of studies/report/web, put together
/// when Glint is built (web.cmake). @GLINT_TITLE@ and @GLINT_DATA@ each stand in it once.
std::string report_page();

}  // namespace glint
