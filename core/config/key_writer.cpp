// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/key_writer.h"

#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "core/text.h"
#include "core/units.h"

namespace glint {
namespace {

/// Absolute, so that the written file can be read from anywhere.
std::string full_name(const std::filesystem::path& file) {
  return file.empty() ? "" : std::filesystem::absolute(file).lexically_normal().string();
}

double rounded_to_digits(double value, int digits) {
  const std::string text = fmt::format("{:.{}g}", value, digits);
  double rounded = value;
  std::from_chars(text.data(), text.data() + text.size(), rounded);
  return rounded;
}

/// An internal value as it is written: the number with the fewest digits (at least 15, so that
/// 90 deg comes back as 90) that reads back as the same internal value.
double written_value(std::string_view key, double internal) {
  const double factor = internal_per_written(key);
  if (factor == 1.0 || !std::isfinite(internal)) {
    return internal;
  }
  const double quotient = internal / factor;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double candidate : {rounded_to_digits(quotient, 15),
                                 rounded_to_digits(quotient, 16),
                                 quotient,
                                 std::nextafter(quotient, kInfinity),
                                 std::nextafter(quotient, -kInfinity)}) {
    if (candidate * factor == internal) {
      return candidate;
    }
  }
  return quotient;
}

}  // namespace

KeyLister::KeyLister(std::string path, std::vector<KeyRow>& rows)
    : path_(std::move(path)), rows_(rows) {}

void KeyLister::add(std::string_view key, KeyRow row) {
  row.path = joined_path(path_, key);
  row.unit = written_unit(key);
  rows_.push_back(std::move(row));
}

void KeyLister::number(std::string_view key,
                       double& value,
                       const Range& range,
                       std::string_view doc) {
  add(key,
      {.kind = "number",
       .allowed = range.text(),
       .default_text = shortest(written_value(key, value)),
       .doc = std::string(doc),
       .range = range});
}

void KeyLister::integer(std::string_view key,
                        int& value,
                        const Range& range,
                        std::string_view doc) {
  add(key,
      {.kind = "integer",
       .allowed = range.text(),
       .default_text = fmt::format("{}", value),
       .doc = std::string(doc),
       .range = range});
}

void KeyLister::boolean(std::string_view key, bool& value, std::string_view doc) {
  add(key,
      {.kind = "boolean",
       .allowed = "true or false",
       .default_text = value ? "true" : "false",
       .doc = std::string(doc)});
}

void KeyLister::text(std::string_view key, std::string& value, std::string_view doc) {
  add(key,
      {.kind = "text",
       .allowed = "any",
       .default_text = fmt::format("\"{}\"", value),
       .doc = std::string(doc)});
}

void KeyLister::file(std::string_view key, std::filesystem::path& value, std::string_view doc) {
  add(key,
      {.kind = "file",
       .allowed = "an existing file",
       .default_text = fmt::format("\"{}\"", value.string()),
       .doc = std::string(doc)});
}

void KeyLister::files(std::string_view key,
                      std::vector<std::filesystem::path>&,
                      std::string_view doc) {
  add(key,
      {.kind = "texts",
       .allowed = "names of existing files",
       .default_text = "[]",
       .doc = std::string(doc)});
}

void KeyLister::numbers(std::string_view key,
                        std::vector<double>& values,
                        Count count,
                        const Range& range,
                        std::string_view doc) {
  std::vector<std::string> parts;
  parts.reserve(values.size());
  for (const double value : values) {
    parts.push_back(shortest(written_value(key, value)));
  }
  add(key,
      {.kind = "numbers",
       .allowed = fmt::format("{}, each {}", count.text(), range.text()),
       .default_text = fmt::format("[{}]", join(parts, ", ")),
       .doc = std::string(doc),
       .range = range,
       .count = count});
}

void KeyLister::interval(std::string_view key,
                         Interval& value,
                         const Range& range,
                         std::string_view doc) {
  const std::string low = shortest(written_value(key, value.min));
  const std::string high = shortest(written_value(key, value.max));
  add(key,
      {.kind = "interval",
       .allowed = fmt::format("a number or [min, max], each {}", range.text()),
       .default_text = value.is_fixed() ? low : fmt::format("[{}, {}]", low, high),
       .doc = std::string(doc),
       .range = range});
}

void KeyLister::choice_index(std::string_view key,
                             int& index,
                             std::span<const std::string_view> names,
                             std::string_view doc) {
  add(key,
      {.kind = "choice",
       .allowed = quoted_list(names),
       .default_text = fmt::format("\"{}\"", names[static_cast<std::size_t>(index)]),
       .doc = std::string(doc),
       .choices = {names.begin(), names.end()}});
}

void KeyLister::table(std::string_view key,
                      const std::function<void(KeyVisitor&)>& visit,
                      std::string_view /*doc*/) {
  KeyLister lister(joined_path(path_, key), rows_);
  visit(lister);
}

bool KeyLister::optional_table(std::string_view key,
                               bool,
                               const std::function<void(KeyVisitor&)>& visit,
                               std::string_view doc) {
  table(key, visit, doc);
  return true;
}

void KeyWriter::put(std::string_view key, ConfigNode node) {
  table_.names.emplace_back(key);
  table_.items.push_back(std::move(node));
}

void KeyWriter::number(std::string_view key, double& value, const Range&, std::string_view) {
  put(key, ConfigNode::from_number(written_value(key, value)));
}

void KeyWriter::integer(std::string_view key, int& value, const Range&, std::string_view) {
  put(key, ConfigNode::from_integer(value));
}

void KeyWriter::boolean(std::string_view key, bool& value, std::string_view) {
  put(key, ConfigNode::from_boolean(value));
}

void KeyWriter::text(std::string_view key, std::string& value, std::string_view) {
  put(key, ConfigNode::from_text(value));
}

void KeyWriter::file(std::string_view key, std::filesystem::path& value, std::string_view) {
  put(key, ConfigNode::from_text(full_name(value)));
}

void KeyWriter::files(std::string_view key,
                      std::vector<std::filesystem::path>& values,
                      std::string_view) {
  ConfigNode node = ConfigNode::array();
  for (const std::filesystem::path& value : values) {
    node.items.push_back(ConfigNode::from_text(full_name(value)));
  }
  put(key, std::move(node));
}

void KeyWriter::numbers(
    std::string_view key, std::vector<double>& values, Count, const Range&, std::string_view) {
  ConfigNode node = ConfigNode::array();
  for (const double value : values) {
    node.items.push_back(ConfigNode::from_number(written_value(key, value)));
  }
  put(key, std::move(node));
}

void KeyWriter::interval(std::string_view key, Interval& value, const Range&, std::string_view) {
  const auto written = [&](double end) { return ConfigNode::from_number(written_value(key, end)); };
  if (value.is_fixed()) {
    put(key, written(value.min));
    return;
  }
  ConfigNode node = ConfigNode::array();
  node.items = {written(value.min), written(value.max)};
  put(key, std::move(node));
}

void KeyWriter::choice_index(std::string_view key,
                             int& index,
                             std::span<const std::string_view> names,
                             std::string_view) {
  put(key, ConfigNode::from_text(std::string(names[static_cast<std::size_t>(index)])));
}

void KeyWriter::table(std::string_view key,
                      const std::function<void(KeyVisitor&)>& visit,
                      std::string_view) {
  ConfigNode node = ConfigNode::table();
  KeyWriter writer(node);
  visit(writer);
  put(key, std::move(node));
}

}  // namespace glint
