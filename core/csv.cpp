// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/csv.h"

#include <algorithm>
#include <charconv>

namespace glint {
namespace {

constexpr std::string_view kBlank = " \t\r";
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr std::string_view kBeginsFormula = "=+-@";

/// Whether an apostrophe goes before it, or one more before those that are there already.
bool needs_apostrophe(std::string_view text) {
  const std::size_t first = text.find_first_not_of('\'');
  return first != text.npos && kBeginsFormula.find(text[first]) != kBeginsFormula.npos;
}

std::string without_apostrophe(std::string text) {
  if (text.starts_with('\'') && needs_apostrophe(text)) {
    text.erase(0, 1);
  }
  return text;
}

class CsvParser {
 public:
  CsvParser(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  bool is_at_end() const { return at_ == text_.size(); }

  bool is_at(char c) const { return !is_at_end() && text_[at_] == c; }

  void skip_blanks() { at_ = std::min(text_.find_first_not_of(kBlank, at_), text_.size()); }

  void skip_line() {
    at_ = std::min(text_.find('\n', at_), text_.size());
    end_line();
  }

  CsvRow row() {
    CsvRow fields = {field()};
    while (is_at(',')) {
      ++at_;
      fields.push_back(field());
    }
    end_line();
    return fields;
  }

 private:
  Place place() const {
    return {.file = file_, .line = line_, .column = static_cast<int>(at_ - line_start_) + 1};
  }

  void end_line() {
    if (!is_at_end()) {
      ++line_;
      line_start_ = ++at_;
    }
  }

  CsvField field() {
    skip_blanks();
    const Place start = place();
    return {.text = without_apostrophe(is_at('"') ? quoted() : plain()), .place = start};
  }

  std::string plain() {
    const std::size_t end = std::min(text_.find_first_of(",\n", at_), text_.size());
    const std::string_view found = text_.substr(at_, end - at_);
    at_ = end;
    return std::string(found.substr(0, found.find_last_not_of(kBlank) + 1));
  }

  std::string quoted() {
    const Place start = place();
    std::string text;
    for (++at_; !is_at('"') || text_.substr(at_).starts_with("\"\""); ++at_) {
      if (is_at_end()) {
        throw ConfigError(start.prefix() + "the quotes of a field are not closed");
      }
      at_ += is_at('"') ? 1U : 0U;
      text += text_[at_];
      if (is_at('\n')) {
        ++line_;
        line_start_ = at_ + 1;
      }
    }
    ++at_;
    skip_blanks();
    if (!is_at_end() && !is_at(',') && !is_at('\n')) {
      throw ConfigError(place().prefix() + "something follows the closing quote of a field");
    }
    return text;
  }

  std::string_view text_;
  const std::string& file_;
  std::size_t at_ = 0;
  std::size_t line_start_ = 0;
  int line_ = 1;
};

/// The text in quotes where reading would give another one without.
std::string written(std::string_view text) {
  const bool has_blank_ends = !text.empty() && (kBlank.find(text.front()) != kBlank.npos ||
                                                kBlank.find(text.back()) != kBlank.npos);
  if (!has_blank_ends && text.find_first_of(",\"\n") == std::string_view::npos) {
    return std::string(text);
  }
  std::string quoted = "\"";
  for (const char c : text) {
    quoted.append(c == '"' ? 2U : 1U, c);
  }
  return quoted + '"';
}

}  // namespace

std::string csv_plain_text(std::string_view text) {
  return (needs_apostrophe(text) ? "'" : "") + std::string(text);
}

std::optional<double> CsvField::number() const {
  const bool has_plus = text.starts_with('+') && !text.starts_with("+-");
  const char* end = text.data() + text.size();
  double value = 0.0;
  const auto [rest, error] = std::from_chars(text.data() + (has_plus ? 1 : 0), end, value);
  return error == std::errc() && rest == end ? std::optional(value) : std::nullopt;
}

std::vector<CsvRow> parse_csv(std::string_view text, const std::string& file, char comment) {
  if (text.starts_with(kByteOrderMark)) {
    text.remove_prefix(kByteOrderMark.size());
  }
  std::vector<CsvRow> rows;
  CsvParser parser(text, file);
  while (!parser.is_at_end()) {
    parser.skip_blanks();
    if (comment != '\0' && parser.is_at(comment)) {
      parser.skip_line();
      continue;
    }
    CsvRow row = parser.row();
    if (row.size() > 1 || !row.front().text.empty()) {
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

std::string csv_row(std::span<const std::string> texts) {
  std::vector<std::string> fields(texts.size());
  std::ranges::transform(texts, fields.begin(), written);
  return join(fields, ",") + '\n';
}

}  // namespace glint
