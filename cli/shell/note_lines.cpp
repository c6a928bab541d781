// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/shell/note_lines.h"

#include <nlohmann/json.hpp>

namespace glint {
namespace {

std::string lines(const std::string& begin, const nlohmann::ordered_json& texts) {
  std::string all;
  for (const nlohmann::ordered_json& text : texts) {
    all += begin + text.get<std::string>() + "\n";
  }
  return all;
}

}  // namespace

std::string note_lines(const nlohmann::ordered_json& notes) {
  return lines("note: ", notes);
}

std::string warning_lines(const nlohmann::ordered_json& warnings) {
  return lines("warning: ", warnings);
}

}  // namespace glint
