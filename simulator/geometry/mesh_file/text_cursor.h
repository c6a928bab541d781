// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner header of glint::geometry::mesh_file: words and numbers of a text file, with their places.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/error.h"

namespace glint::mesh_file {

/// Reads a text word by word and knows line and column of the last word. '#' starts a comment.
class TextCursor {
 public:
  /// The text must outlive the cursor.
  TextCursor(std::string_view text, std::string file);

  std::string_view next_word();     ///< over line ends; empty at the end of the text
  std::string_view word_on_line();  ///< empty at the end of the line; the line end stays
  void skip_line();                 ///< to the beginning of the next line

  bool at_end() const { return position_ >= text_.size(); }

  /// Numbers and counts over line ends, or on this line only; what names them in messages.
  double number(std::string_view what);
  double number_on_line(std::string_view what);
  std::int64_t integer(std::string_view what);
  /// A word as a number or an integer. @throws ConfigError at the last word's place
  double to_number(std::string_view word, std::string_view what) const;
  std::int64_t to_integer(std::string_view word, std::string_view what) const;

  std::size_t position() const { return position_; }

  std::size_t remaining() const { return text_.size() - position_; }

  const Place& place() const { return place_; }  ///< of the last word

  [[noreturn]] void fail(const std::string& message) const;

 private:
  void skip_blanks();
  std::string_view take_word();

  std::string_view text_;
  std::size_t position_ = 0;
  int line_ = 1;
  std::size_t line_begin_ = 0;
  Place place_;
};

}  // namespace glint::mesh_file
