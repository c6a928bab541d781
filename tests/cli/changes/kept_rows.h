// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rows of results that are kept in a file between runs, one a line.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/file.h"

namespace glint::test {

/// The rows of a file, none where there is no file. A last line without its end was cut when a run
/// was stopped: it is removed, so that the next row begins a line.
inline std::vector<nlohmann::json> kept_rows(const std::filesystem::path& file) {
  std::vector<nlohmann::json> rows;
  if (!std::filesystem::exists(file)) {
    return rows;
  }
  const std::string text = read_file(file);
  std::size_t begin = 0;
  for (std::size_t end = 0; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1) {
    rows.push_back(nlohmann::json::parse(text.substr(begin, end - begin)));
  }
  if (begin < text.size()) {
    std::filesystem::resize_file(file, begin);
  }
  return rows;
}

}  // namespace glint::test
