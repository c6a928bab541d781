// SPDX-License-Identifier: GPL-3.0-or-later
//
// Settings written out: as rows for people to read, and as a table that can be read again.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/keys.h"

namespace glint {

/// A row of the key table.
struct KeyRow {
  std::string path;  ///< "lighting.tunnel.radius_mm"
  std::string kind;  ///< number, integer, boolean, choice, text, file, texts, numbers, interval
  std::string unit;  ///< empty when dimensionless
  std::string allowed;
  std::string default_text;
  std::string doc;
  // `allowed` for programs, in the written unit.
  Range range = {};                       ///< of a number, an integer, each end of an interval
  Count count = {};                       ///< of numbers
  std::vector<std::string> choices = {};  ///< of a choice
};

/// Lists rows of the key table under a path.
class KeyLister final : public KeyVisitor {
 public:
  KeyLister(std::string path, std::vector<KeyRow>& rows);

  void number(std::string_view, double&, const Range&, std::string_view) override;
  void integer(std::string_view, int&, const Range&, std::string_view) override;
  void boolean(std::string_view, bool&, std::string_view) override;
  void text(std::string_view, std::string&, std::string_view) override;
  void file(std::string_view, std::filesystem::path&, std::string_view) override;
  void files(std::string_view, std::vector<std::filesystem::path>&, std::string_view) override;
  void numbers(
      std::string_view, std::vector<double>&, Count, const Range&, std::string_view) override;
  void interval(std::string_view, Interval&, const Range&, std::string_view) override;
  void choice_index(std::string_view,
                    int&,
                    std::span<const std::string_view>,
                    std::string_view) override;
  void table(std::string_view, const std::function<void(KeyVisitor&)>&, std::string_view) override;
  bool optional_table(std::string_view,
                      bool,
                      const std::function<void(KeyVisitor&)>&,
                      std::string_view) override;

  using KeyVisitor::optional_table;

  void require(bool, std::string_view, const std::string&) override {}

  bool is_given(std::string_view) const override { return false; }

 private:
  void add(std::string_view key, KeyRow row);

  std::string path_;
  std::vector<KeyRow>& rows_;
};

/// Writes settings back as a table, in written units and with every key present.
class KeyWriter final : public KeyVisitor {
 public:
  explicit KeyWriter(ConfigNode& table) : table_(table) {}

  void number(std::string_view, double&, const Range&, std::string_view) override;
  void integer(std::string_view, int&, const Range&, std::string_view) override;
  void boolean(std::string_view, bool&, std::string_view) override;
  void text(std::string_view, std::string&, std::string_view) override;
  void file(std::string_view, std::filesystem::path&, std::string_view) override;
  void files(std::string_view, std::vector<std::filesystem::path>&, std::string_view) override;
  void numbers(
      std::string_view, std::vector<double>&, Count, const Range&, std::string_view) override;
  void interval(std::string_view, Interval&, const Range&, std::string_view) override;
  void choice_index(std::string_view,
                    int&,
                    std::span<const std::string_view>,
                    std::string_view) override;
  void table(std::string_view, const std::function<void(KeyVisitor&)>&, std::string_view) override;

  void require(bool, std::string_view, const std::string&) override {}

  bool is_given(std::string_view) const override { return false; }

 private:
  void put(std::string_view key, ConfigNode node);

  ConfigNode& table_;
};

}  // namespace glint
