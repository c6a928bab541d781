// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/keys.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "core/text.h"
#include "core/units.h"

namespace glint {
namespace {

using Kind = Problem::Kind;

std::string joined_path(std::string_view path, std::string_view key) {
  return path.empty() ? std::string(key) : fmt::format("{}.{}", path, key);
}

std::string quoted_list(std::span<const std::string_view> names) {
  return fmt::format("\"{}\"", fmt::join(names.begin(), names.end(), "\", \""));
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

/// "3 numbers", "at least 2 numbers", "2 to 5 numbers".
std::string count_text(Count count) {
  if (count.min == count.max) {
    return fmt::format("{} numbers", count.min);
  }
  return count.max == Count{}.max ? fmt::format("at least {} numbers", count.min)
                                  : fmt::format("{} to {} numbers", count.min, count.max);
}

}  // namespace

std::string Range::text() const {
  const bool has_min = std::isfinite(min);
  const bool has_max = std::isfinite(max);
  if (has_min && has_max) {
    return fmt::format("in {}{}, {}]", min_excluded ? "(" : "[", shortest(min), shortest(max));
  }
  if (has_min) {
    return fmt::format("{} {}", min_excluded ? ">" : ">=", shortest(min));
  }
  return has_max ? fmt::format("<= {}", shortest(max)) : "any";
}

KeyReader::KeyReader(const ConfigNode* table, std::string path, std::vector<Problem>& errors)
    : table_(table), path_(std::move(path)), errors_(errors) {
  if (table_ != nullptr && !table_->is_table()) {
    errors_.push_back({.kind = Problem::Kind::kWrongType,
                       .place = table_->place,
                       .key = path_,
                       .text = fmt::format("must be a table, like [{}]", path_)});
    table_ = nullptr;
  }
}

const ConfigNode* KeyReader::take(std::string_view key) {
  known_.emplace_back(key);
  return table_ == nullptr ? nullptr : table_->find(key);
}

void KeyReader::error(const ConfigNode* where,
                      std::string_view key,
                      const std::string& message,
                      Problem::Kind kind) {
  const ConfigNode* node = where != nullptr ? where : table_;
  errors_.push_back({.kind = kind,
                     .place = node != nullptr ? node->place : Place{},
                     .key = joined_path(path_, key),
                     .text = message});
}

bool KeyReader::number_in_range(const ConfigNode& node,
                                std::string_view key,
                                const Range& range,
                                double* written) {
  if (!node.is_number()) {
    error(&node, key, fmt::format("must be a number, {}", range.text()), Kind::kWrongType);
    return false;
  }
  if (!std::isfinite(node.number)) {
    error(&node,
          key,
          fmt::format("is {}, must be a finite number", shortest(node.number)),
          Kind::kOutOfRange);
    return false;
  }
  if (!range.contains(node.number)) {
    error(&node,
          key,
          fmt::format("is {}, must be {}", shortest(node.number), range.text()),
          Kind::kOutOfRange);
    return false;
  }
  *written = node.number;
  return true;
}

void KeyReader::number(std::string_view key,
                       double& value,
                       const Range& range,
                       std::string_view /*doc*/) {
  const ConfigNode* node = take(key);
  double written = 0.0;
  if (node != nullptr && number_in_range(*node, key, range, &written)) {
    value = written * internal_per_written(key);
  }
}

void KeyReader::integer(std::string_view key,
                        int& value,
                        const Range& range,
                        std::string_view /*doc*/) {
  const ConfigNode* node = take(key);
  double written = 0.0;
  if (node == nullptr || !number_in_range(*node, key, range, &written)) {
    return;
  }
  if (written != std::floor(written) || std::abs(written) > 2e9) {
    error(node,
          key,
          fmt::format("is {}, must be a whole number of at most 2e9", shortest(written)),
          Kind::kOutOfRange);
    return;
  }
  value = static_cast<int>(written);
}

void KeyReader::boolean(std::string_view key, bool& value, std::string_view /*doc*/) {
  const ConfigNode* node = take(key);
  if (node == nullptr) {
    return;
  }
  if (node->kind != ConfigNode::Kind::kBoolean) {
    error(node, key, "must be true or false", Kind::kWrongType);
    return;
  }
  value = node->boolean;
}

void KeyReader::text(std::string_view key, std::string& value, std::string_view /*doc*/) {
  const ConfigNode* node = take(key);
  if (node == nullptr) {
    return;
  }
  if (node->kind != ConfigNode::Kind::kText) {
    error(node, key, "must be a text in quotes", Kind::kWrongType);
    return;
  }
  value = node->text;
}

void KeyReader::file(std::string_view key, std::filesystem::path& value, std::string_view /*doc*/) {
  const ConfigNode* node = take(key);
  if (node == nullptr) {
    return;
  }
  if (node->kind != ConfigNode::Kind::kText) {
    error(node, key, "must be a file name in quotes", Kind::kWrongType);
    return;
  }
  value = node->text.empty() ? std::filesystem::path() : resolve_path(*node);
  std::error_code ignored;
  if (!value.empty() && !std::filesystem::exists(value, ignored)) {
    error(node, key, fmt::format("the file {} does not exist", value.string()));
  }
}

void KeyReader::numbers(std::string_view key,
                        std::vector<double>& values,
                        Count count,
                        const Range& range,
                        std::string_view /*doc*/) {
  const ConfigNode* node = take(key);
  if (node == nullptr) {
    return;
  }
  const auto size = static_cast<int>(node->items.size());
  if (!node->is_array() || size < count.min || size > count.max) {
    error(node, key, fmt::format("must be an array of {}", count_text(count)), Kind::kWrongType);
    return;
  }
  std::vector<double> read;
  for (const ConfigNode& item : node->items) {
    double written = 0.0;
    if (!number_in_range(item, key, range, &written)) {
      return;
    }
    read.push_back(written * internal_per_written(key));
  }
  values = std::move(read);
}

void KeyReader::interval(std::string_view key,
                         Interval& value,
                         const Range& range,
                         std::string_view /*doc*/) {
  const ConfigNode* node = take(key);
  if (node == nullptr) {
    return;
  }
  double low = 0.0;
  double high = 0.0;
  if (!node->is_array()) {
    if (!number_in_range(*node, key, range, &low)) {
      return;
    }
    high = low;
  } else if (node->items.size() != 2) {
    error(node,
          key,
          fmt::format("must be a number or [min, max], each {}", range.text()),
          Kind::kWrongType);
    return;
  } else if (!number_in_range(node->items[0], key, range, &low) ||
             !number_in_range(node->items[1], key, range, &high)) {
    return;
  }
  if (low > high) {
    error(node,
          key,
          fmt::format(
              "is [{}, {}], must be [min, max] with min <= max", shortest(low), shortest(high)),
          Kind::kOutOfRange);
    return;
  }
  value = {low * internal_per_written(key), high * internal_per_written(key)};
}

void KeyReader::choice_index(std::string_view key,
                             int& index,
                             std::span<const std::string_view> names,
                             std::string_view /*doc*/) {
  const ConfigNode* node = take(key);
  if (node == nullptr) {
    return;
  }
  const auto position = node->kind == ConfigNode::Kind::kText
                            ? std::ranges::find(names, std::string_view(node->text))
                            : names.end();
  if (position == names.end()) {
    error(node,
          key,
          fmt::format("is {}, must be one of {}", value_to_toml(*node), quoted_list(names)),
          Kind::kOutOfRange);
    return;
  }
  index = static_cast<int>(position - names.begin());
}

void KeyReader::table(std::string_view key,
                      const std::function<void(KeyVisitor&)>& visit,
                      std::string_view /*doc*/) {
  KeyReader reader(take(key), joined_path(path_, key), errors_);
  visit(reader);
  reader.report_unknown();
}

void KeyReader::require(bool holds, std::string_view key, const std::string& message) {
  if (!holds) {
    error(table_ == nullptr ? nullptr : table_->find(key), key, message, Kind::kRelation);
  }
}

bool KeyReader::is_given(std::string_view key) const {
  return table_ != nullptr && table_->find(key) != nullptr;
}

void KeyReader::report_unknown() {
  if (table_ == nullptr) {
    return;
  }
  for (std::size_t i = 0; i < table_->names.size(); ++i) {
    const std::string& name = table_->names[i];
    if (std::ranges::find(known_, name) == known_.end()) {
      const std::string near = nearest(name, known_);
      error(&table_->items[i],
            name,
            near.empty() ? "unknown key"
                         : fmt::format("unknown key, the nearest known one is \"{}\"", near),
            Kind::kUnknownKey);
    }
  }
}

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
       .doc = std::string(doc)});
}

void KeyLister::integer(std::string_view key,
                        int& value,
                        const Range& range,
                        std::string_view doc) {
  add(key,
      {.kind = "integer",
       .allowed = range.text(),
       .default_text = fmt::format("{}", value),
       .doc = std::string(doc)});
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
       .allowed = fmt::format("{}, each {}", count_text(count), range.text()),
       .default_text = fmt::format("[{}]", join(parts, ", ")),
       .doc = std::string(doc)});
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
       .doc = std::string(doc)});
}

void KeyLister::choice_index(std::string_view key,
                             int& index,
                             std::span<const std::string_view> names,
                             std::string_view doc) {
  add(key,
      {.kind = "choice",
       .allowed = quoted_list(names),
       .default_text = fmt::format("\"{}\"", names[static_cast<std::size_t>(index)]),
       .doc = std::string(doc)});
}

void KeyLister::table(std::string_view key,
                      const std::function<void(KeyVisitor&)>& visit,
                      std::string_view /*doc*/) {
  KeyLister lister(joined_path(path_, key), rows_);
  visit(lister);
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
  // Absolute, so that the written file can be read from anywhere.
  const std::filesystem::path full =
      value.empty() ? value : std::filesystem::absolute(value).lexically_normal();
  put(key, ConfigNode::from_text(full.string()));
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

namespace {

template <class Value>
void append_bytes(std::string& bytes, const Value& value) {
  std::array<char, sizeof(Value)> raw;
  std::memcpy(raw.data(), &value, sizeof(Value));
  bytes.append(raw.data(), raw.size());
}

/// With its length, so that two texts cannot be taken for one.
void append_text(std::string& bytes, std::string_view value) {
  append_bytes(bytes, value.size());
  bytes += value;
}

}  // namespace

void KeyDigest::number(std::string_view, double& value, const Range&, std::string_view) {
  append_bytes(bytes_, value == 0.0 ? 0.0 : value);  // no difference between 0 and -0
}

void KeyDigest::integer(std::string_view, int& value, const Range&, std::string_view) {
  append_bytes(bytes_, value);
}

void KeyDigest::boolean(std::string_view, bool& value, std::string_view) {
  bytes_ += value ? '1' : '0';
}

void KeyDigest::text(std::string_view, std::string& value, std::string_view) {
  append_text(bytes_, value);
}

void KeyDigest::file(std::string_view, std::filesystem::path& value, std::string_view) {
  append_text(bytes_, value.string());
}

void KeyDigest::numbers(
    std::string_view, std::vector<double>& values, Count, const Range&, std::string_view) {
  append_bytes(bytes_, values.size());
  for (const double value : values) {
    append_bytes(bytes_, value == 0.0 ? 0.0 : value);
  }
}

void KeyDigest::interval(std::string_view, Interval& value, const Range&, std::string_view) {
  append_bytes(bytes_, value.min == 0.0 ? 0.0 : value.min);
  append_bytes(bytes_, value.max == 0.0 ? 0.0 : value.max);
}

void KeyDigest::choice_index(std::string_view,
                             int& index,
                             std::span<const std::string_view>,
                             std::string_view) {
  append_bytes(bytes_, index);
}

void KeyDigest::table(std::string_view,
                      const std::function<void(KeyVisitor&)>& visit,
                      std::string_view) {
  visit(*this);
}

void throw_if_any(const std::vector<Problem>& errors) {
  if (!errors.empty()) {
    throw ConfigError(errors);
  }
}

}  // namespace glint
