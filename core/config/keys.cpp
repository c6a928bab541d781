// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/keys.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "core/text.h"
#include "core/units.h"

namespace glint {
namespace {

/// The nearest key, one that holds the whole name ("inner_radius_mm" for "radius_mm") before
/// others.
std::string nearest_key(const std::string& name, const std::vector<std::string>& known) {
  std::vector<std::string> holders;
  std::ranges::copy_if(known, std::back_inserter(holders), [&](const std::string& key) {
    return key.find(name) != std::string::npos;
  });
  return nearest(name, holders.empty() ? known : holders);
}

/// A number as people write it: 100000, not 1e+05; from 1e9 on as a power of ten.
std::string told(double value) {
  constexpr double kWritesPower = 1e9;
  const bool is_whole = std::abs(value) < kWritesPower && value == std::floor(value);
  return is_whole ? fmt::format("{:.0f}", value + 0.0) : shortest(value);
}

using Kind = Problem::Kind;

}  // namespace

std::string joined_path(std::string_view path, std::string_view key) {
  return path.empty() ? std::string(key) : fmt::format("{}.{}", path, key);
}

std::string quoted_list(std::span<const std::string_view> names) {
  return fmt::format("\"{}\"", fmt::join(names.begin(), names.end(), "\", \""));
}

std::string Count::text() const {
  if (min == max) {
    return fmt::format("{} numbers", min);
  }
  return max == Count{}.max ? fmt::format("at least {} numbers", min)
                            : fmt::format("{} to {} numbers", min, max);
}

bool Range::contains(double value) const {
  const auto is_value = [&](int allowed) { return value == static_cast<double>(allowed); };
  return value <= max && (min_excluded ? value > min : value >= min) &&
         (only.empty() || std::ranges::any_of(only, is_value));
}

std::string Range::text() const {
  if (!only.empty()) {
    return fmt::format("one of {}", fmt::join(only, ", "));
  }
  const bool has_min = std::isfinite(min);
  const bool has_max = std::isfinite(max);
  if (has_min && has_max) {
    return fmt::format("in {}{}, {}]", min_excluded ? "(" : "[", told(min), told(max));
  }
  if (has_min) {
    return fmt::format("{} {}", min_excluded ? ">" : ">=", told(min));
  }
  return has_max ? fmt::format("<= {}", told(max)) : "any";
}

bool KeyVisitor::optional_table(std::string_view key,
                                bool is_there,
                                const std::function<void(KeyVisitor&)>& visit,
                                std::string_view doc) {
  if (is_there) {
    table(key, visit, doc);
  }
  return is_there;
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
          fmt::format("is {}, must be {}", told(node.number), range.text()),
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

std::optional<std::filesystem::path> KeyReader::existing_file(const ConfigNode& node,
                                                              std::string_view key) {
  if (node.kind != ConfigNode::Kind::kText) {
    error(&node, key, "must be a file name in quotes", Kind::kWrongType);
    return std::nullopt;
  }
  std::filesystem::path file = node.text.empty() ? std::filesystem::path() : resolve_path(node);
  std::error_code ignored;
  if (!file.empty() && !std::filesystem::exists(file, ignored)) {
    error(&node, key, fmt::format("the file {} does not exist", file.string()));
  }
  return file;
}

void KeyReader::file(std::string_view key, std::filesystem::path& value, std::string_view /*doc*/) {
  const ConfigNode* node = take(key);
  if (node != nullptr) {
    value = existing_file(*node, key).value_or(value);
  }
}

void KeyReader::files(std::string_view key,
                      std::vector<std::filesystem::path>& values,
                      std::string_view /*doc*/) {
  const ConfigNode* node = take(key);
  if (node == nullptr) {
    return;
  }
  if (!node->is_array()) {
    error(node, key, "must be an array of file names in quotes", Kind::kWrongType);
    return;
  }
  values.clear();
  for (const ConfigNode& item : node->items) {
    if (auto file = existing_file(item, key)) {
      values.push_back(std::move(*file));
    }
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
    error(node, key, fmt::format("must be an array of {}", count.text()), Kind::kWrongType);
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

bool KeyReader::optional_table(std::string_view key,
                               bool /*is_there*/,
                               const std::function<void(KeyVisitor&)>& visit,
                               std::string_view doc) {
  if (take(key) == nullptr) {
    return false;
  }
  table(key, visit, doc);
  return true;
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
      const std::string near = nearest_key(name, known_);
      error(&table_->items[i],
            name,
            near.empty() ? "unknown key"
                         : fmt::format("unknown key, the nearest known one is \"{}\"", near),
            Kind::kUnknownKey);
    }
  }
}

void throw_if_any(const std::vector<Problem>& errors) {
  if (!errors.empty()) {
    throw ConfigError(errors);
  }
}

}  // namespace glint
