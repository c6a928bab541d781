// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pieces of the page of `glint inspect`.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "metrics/inspection/grading.h"

namespace glint::inspect_html {

/// "1 part", "2 parts"
std::string plural(std::int64_t count, std::string_view word);

std::string badge(const std::optional<Grade>& grade);

/// Numbers stand to the right.
std::string cell(std::string_view text, bool is_number = true);

/// The head of a table; names of columns of texts begin with "!".
std::string heads(std::initializer_list<std::string_view> words);

/// Four digits.
std::string number(double value);

}  // namespace glint::inspect_html
