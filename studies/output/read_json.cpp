// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/output/read_json.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"

namespace glint {

nlohmann::ordered_json read_json(const std::filesystem::path& path) {
  try {
    return nlohmann::ordered_json::parse(read_file(path));
  } catch (const nlohmann::ordered_json::parse_error& error) {
    throw IoError(fmt::format("{}: is damaged: {}", path.string(), error.what()));
  }
}

}  // namespace glint
