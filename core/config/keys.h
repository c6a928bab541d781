// SPDX-License-Identifier: GPL-3.0-or-later
//
// The key table. Each settings struct has one function
//
//     void visit_keys(KeyVisitor& keys, TunnelSettings& settings);
//
// that names every key with its range, default (the struct's own value) and one-line doc. Reading a
// file, listing the table for `glint explain` and the docs, and writing the resolved configuration
// are three visitors over that one function, so they cannot disagree. Units are converted here and
// nowhere else, from the key's suffix (core/units.h).
#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/config/config.h"

namespace glint {

/// Allowed range of a number, in the unit the key is written in.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool min_excluded = false;
  std::span<const int> only = {};  ///< no other number is allowed; empty: all between min and max

  static Range positive() { return {.min = 0.0, .min_excluded = true}; }

  static Range at_least(double min) { return {.min = min}; }

  static Range between(double min, double max) { return {.min = min, .max = max}; }

  /// @param values  rising, at least one; must outlive the range
  static Range one_of(std::span<const int> values) {
    return {.min = static_cast<double>(values.front()),
            .max = static_cast<double>(values.back()),
            .only = values};
  }

  bool contains(double value) const;

  std::string text() const;  ///< "> 0", "in [0, 1]", "one of 8, 12", "any"
};

/// A fixed number (min = max), or a range that a number is drawn from.
struct Interval {
  double min = 0.0;
  double max = 0.0;

  constexpr Interval() = default;

  constexpr Interval(double value) : min(value), max(value) {}  // NOLINT(*-explicit-*): is one

  constexpr Interval(double low, double high) : min(low), max(high) {}

  bool is_fixed() const { return min == max; }

  /// @param share  in [0, 1]: from min to max
  double at(double share) const { return min + (max - min) * share; }
};

/// How many numbers an array may hold.
struct Count {
  int min = 0;
  int max = std::numeric_limits<int>::max();

  std::string text() const;  ///< "3 numbers", "at least 2 numbers", "2 to 5 numbers"
};

/// "lighting", "tunnel" -> "lighting.tunnel"
std::string joined_path(std::string_view path, std::string_view key);

/// "a", "b", "c", in quotes.
std::string quoted_list(std::span<const std::string_view> names);

/// Walks the keys of a settings struct; see the head of this file.
class KeyVisitor {
 public:
  KeyVisitor() = default;
  virtual ~KeyVisitor() = default;
  KeyVisitor(const KeyVisitor&) = delete;
  KeyVisitor& operator=(const KeyVisitor&) = delete;

  /// The value is held in the internal unit, the range is in the written one.
  virtual void number(std::string_view key,
                      double& value,
                      const Range& range,
                      std::string_view doc) = 0;
  virtual void integer(std::string_view key,
                       int& value,
                       const Range& range,
                       std::string_view doc) = 0;
  virtual void boolean(std::string_view key, bool& value, std::string_view doc) = 0;
  virtual void text(std::string_view key, std::string& value, std::string_view doc) = 0;
  virtual void file(std::string_view key, std::filesystem::path& value, std::string_view doc) = 0;
  virtual void files(std::string_view key,
                     std::vector<std::filesystem::path>& values,
                     std::string_view doc) = 0;
  virtual void numbers(std::string_view key,
                       std::vector<double>& values,
                       Count count,
                       const Range& range,
                       std::string_view doc) = 0;
  /// A number, or [min, max] with min <= max.
  virtual void interval(std::string_view key,
                        Interval& value,
                        const Range& range,
                        std::string_view doc) = 0;
  virtual void choice_index(std::string_view key,
                            int& index,
                            std::span<const std::string_view> names,
                            std::string_view doc) = 0;
  /// A nested table.
  virtual void table(std::string_view key,
                     const std::function<void(KeyVisitor&)>& visit,
                     std::string_view doc) = 0;
  /// A nested table that may be missing. @return whether it was visited: when it is written in the
  /// file, when there is one to be written, and always by lists of keys
  virtual bool optional_table(std::string_view key,
                              bool is_there,
                              const std::function<void(KeyVisitor&)>& visit,
                              std::string_view doc);
  /// A condition between keys; the message says what is wrong and what is allowed.
  virtual void require(bool holds, std::string_view key, const std::string& message) = 0;
  /// True when the user wrote that key (always false outside reading).
  virtual bool is_given(std::string_view key) const = 0;

  /// A choice held as an enum whose values count from 0 in the order of the names.
  template <class Enum>
  void choice(std::string_view key,
              Enum& value,
              std::span<const std::string_view> names,
              std::string_view doc) {
    int index = static_cast<int>(value);
    choice_index(key, index, names, doc);
    value = static_cast<Enum>(index);
  }

  /// A nested table of settings that may be missing.
  template <class Settings>
  void optional_table(std::string_view key, std::optional<Settings>& value, std::string_view doc) {
    Settings settings = value.value_or(Settings{});
    const auto visit = [&](KeyVisitor& inner) { visit_keys(inner, settings); };
    if (optional_table(key, value.has_value(), visit, doc)) {
      value = std::move(settings);
    }
  }
};

/// Reads one table into settings and collects every problem instead of stopping at the first.
class KeyReader final : public KeyVisitor {
 public:
  /// @param table   nullptr: the table is absent, every key keeps its default
  /// @param path    dotted path of the table, for messages
  /// @param errors  grows by the problems found
  KeyReader(const ConfigNode* table, std::string path, std::vector<Problem>& errors);

  void number(std::string_view key, double& value, const Range& range, std::string_view) override;
  void integer(std::string_view key, int& value, const Range& range, std::string_view) override;
  void boolean(std::string_view key, bool& value, std::string_view) override;
  void text(std::string_view key, std::string& value, std::string_view) override;
  void file(std::string_view key, std::filesystem::path& value, std::string_view) override;
  void files(std::string_view key,
             std::vector<std::filesystem::path>& values,
             std::string_view) override;
  void numbers(std::string_view key,
               std::vector<double>& values,
               Count count,
               const Range& range,
               std::string_view) override;
  void interval(std::string_view key,
                Interval& value,
                const Range& range,
                std::string_view) override;
  void choice_index(std::string_view key,
                    int& index,
                    std::span<const std::string_view> names,
                    std::string_view) override;
  void table(std::string_view key,
             const std::function<void(KeyVisitor&)>& visit,
             std::string_view) override;
  bool optional_table(std::string_view key,
                      bool is_there,
                      const std::function<void(KeyVisitor&)>& visit,
                      std::string_view) override;
  using KeyVisitor::optional_table;
  void require(bool holds, std::string_view key, const std::string& message) override;
  bool is_given(std::string_view key) const override;

  /// Reports every key of the table that nobody asked for, with the nearest known one.
  void report_unknown();

  /// The item, marked as known; nullptr when absent.
  const ConfigNode* take(std::string_view key);
  void error(const ConfigNode* where,
             std::string_view key,
             const std::string& message,
             Problem::Kind kind = Problem::Kind::kOther);

 private:
  std::optional<std::filesystem::path> existing_file(const ConfigNode& node, std::string_view key);
  bool number_in_range(const ConfigNode& node,
                       std::string_view key,
                       const Range& range,
                       double* written);

  const ConfigNode* table_;
  std::string path_;
  std::vector<Problem>& errors_;
  std::vector<std::string> known_;
};

/// Throws ConfigError with all problems when there are any.
void throw_if_any(const std::vector<Problem>& errors);

}  // namespace glint
