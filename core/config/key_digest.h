// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/keys.h"

namespace glint {

/// Appends the values of settings to a string: equal strings mean equal settings of the same kind.
/// For finding earlier results again; not for files.
class KeyDigest final : public KeyVisitor {
 public:
  explicit KeyDigest(std::string& bytes) : bytes_(bytes) {}

  void number(std::string_view, double& value, const Range&, std::string_view) override;
  void integer(std::string_view, int& value, const Range&, std::string_view) override;
  void boolean(std::string_view, bool& value, std::string_view) override;
  void text(std::string_view, std::string& value, std::string_view) override;
  void file(std::string_view, std::filesystem::path& value, std::string_view) override;
  void files(std::string_view,
             std::vector<std::filesystem::path>& values,
             std::string_view) override;
  void numbers(std::string_view,
               std::vector<double>& values,
               Count,
               const Range&,
               std::string_view) override;
  void interval(std::string_view, Interval& value, const Range&, std::string_view) override;
  void choice_index(std::string_view,
                    int& index,
                    std::span<const std::string_view>,
                    std::string_view) override;
  void table(std::string_view,
             const std::function<void(KeyVisitor&)>& visit,
             std::string_view) override;

  void require(bool, std::string_view, const std::string&) override {}

  bool is_given(std::string_view) const override { return false; }

 private:
  std::string& bytes_;
};

}  // namespace glint
