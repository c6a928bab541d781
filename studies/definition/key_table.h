// SPDX-License-Identifier: GPL-3.0-or-later
//
// All that a study file may hold, as rows: for `glint explain`, the shells' completions and the
// schema of study files.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "core/config/key_writer.h"
#include "defects/definition/defect_settings.h"

namespace glint {

/// The tables of one name, and keys that stand in no table.
struct KeyGroup {
  std::string_view name;  ///< first part of the keys' paths: "part", "lighting", "title"
  std::string_view doc;
};

/// In the order in which a study file has them.
std::span<const KeyGroup> key_groups();

/// Every key: of the file itself, of the scene, of the study.
std::vector<KeyRow> all_keys();

/// The keys of a table of defects that a defect of this type has a use for.
std::vector<KeyRow> keys_of(DefectType type);

}  // namespace glint
