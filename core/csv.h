// SPDX-License-Identifier: GPL-3.0-or-later
//
// Tables as comma-separated values (RFC 4180), read with places and written.
#pragma once

#include <concepts>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/text.h"

namespace glint {

struct CsvField {
  std::string text;  ///< without the quotes; without blanks around it where it has no quotes
  Place place;       ///< of its first character

  /// A whole field as a number, also with a plus sign.
  std::optional<double> number() const;
};

/// At least one field.
using CsvRow = std::vector<CsvField>;

/// A text that begins with =, +, - or @ is a formula where a spreadsheet opens the file: it is
/// written with an apostrophe before it, which spreadsheets hide and parse_csv() takes off.
std::string csv_plain_text(std::string_view text);

/// All rows but empty ones and those that begin with the mark of a comment ('\0': there are none).
/// Rows may differ in length. A field in quotes may hold commas, line ends and doubled quotes.
/// @param file  for messages
/// @throws ConfigError with file:line:column, where quotes are not closed or something follows them
std::vector<CsvRow> parse_csv(std::string_view text, const std::string& file, char comment = '\0');

/// A row with its line end; texts stand in quotes where reading needs them.
std::string csv_row(std::span<const std::string> texts);

namespace detail {

template <std::convertible_to<std::string_view> Text>
std::string csv_text(const Text& text) {
  return csv_plain_text(text);
}

template <std::integral Integer>
std::string csv_text(Integer value) {
  static_assert(!std::same_as<Integer, bool> && !std::same_as<Integer, char>, "say what it means");
  return std::to_string(value);
}

template <std::floating_point Number>
std::string csv_text(Number value) {
  return shortest(value);
}

}  // namespace detail

/// A row of texts, integers and floating-point numbers, which read back as the same.
template <class... Fields>
std::string csv_row_of(const Fields&... fields) {
  return csv_row(std::vector<std::string>{detail::csv_text(fields)...});
}

}  // namespace glint
