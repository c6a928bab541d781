// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/key_table.h"

#include <algorithm>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "metrics/scores.h"

namespace glint {
namespace {

std::set<std::string> paths_of(const std::vector<KeyRow>& rows) {
  std::set<std::string> paths;
  for (const KeyRow& row : rows) {
    paths.insert(row.path);
  }
  return paths;
}

TEST(KeyTable, EveryKeyIsOfAGroupAndEveryGroupHasKeys) {
  std::set<std::string> groups;
  for (const KeyGroup& group : key_groups()) {
    EXPECT_NE(group.doc, "") << group.name;
    groups.emplace(group.name);
  }
  EXPECT_EQ(groups.size(), key_groups().size());
  std::set<std::string> used;
  for (const KeyRow& row : all_keys()) {
    used.insert(row.path.substr(0, row.path.find('.')));
  }
  EXPECT_EQ(used, groups);
}

// inspection.threshold is how the threshold is found, and as a score the one that was found.
TEST(KeyTable, EveryKeyIsThereOnceAndAllButOneAreNoScores) {
  const std::vector<KeyRow> rows = all_keys();
  EXPECT_EQ(paths_of(rows).size(), rows.size());
  for (const KeyRow& row : rows) {
    EXPECT_EQ(explain_score(row.path).has_value(), row.path == "inspection.threshold") << row.path;
  }
}

TEST(KeyTable, TellsProgramsWhatItTellsPeople) {
  for (const KeyRow& row : all_keys()) {
    if (row.kind == "number" || row.kind == "integer") {
      EXPECT_TRUE(row.allowed == row.range.text() || row.path == "schema") << row.path;
    }
    if (row.kind == "numbers") {
      EXPECT_EQ(row.allowed, row.count.text() + ", each " + row.range.text()) << row.path;
    }
    EXPECT_EQ(row.kind == "choice", !row.choices.empty()) << row.path;
  }
}

// A scratch is drawn out along a line, a dent is round, a stain has a colour.
TEST(KeysOf, ADefectAreThoseThatItsTypeHasAUseFor) {
  const std::set<std::string> scratch = paths_of(keys_of(DefectType::kScratch));
  EXPECT_TRUE(scratch.contains("defects.scratch.length_mm"));
  EXPECT_TRUE(scratch.contains("defects.scratch.width_mm"));
  EXPECT_TRUE(scratch.contains("defects.scratch.height_um"));
  EXPECT_TRUE(scratch.contains("defects.scratch.tool_level")) << "imprinted: is no type";
  EXPECT_TRUE(scratch.contains("defects.scratch.type")) << "its doc names several types";
  EXPECT_FALSE(scratch.contains("defects.scratch.diameter_mm"));
  EXPECT_FALSE(scratch.contains("defects.scratch.colour"));
  const std::set<std::string> stain = paths_of(keys_of(DefectType::kStain));
  EXPECT_TRUE(stain.contains("defects.stain.diameter_mm"));
  EXPECT_TRUE(stain.contains("defects.stain.colour"));
  EXPECT_FALSE(stain.contains("defects.stain.length_mm"));
}

// A key that is told apart by another name than the table's would be listed nowhere, or always.
TEST(KeysOf, ADefectAreOneTableForAllTypesTogether) {
  const std::set<std::string> dent = paths_of(keys_of(DefectType::kDent));
  const std::set<std::string> gouge = paths_of(keys_of(DefectType::kGouge));
  const std::set<std::string> stain = paths_of(keys_of(DefectType::kStain));
  const std::set<std::string> all = paths_of(all_keys());
  EXPECT_EQ(gouge.size(), dent.size() + 1) << "length and width for a diameter";
  EXPECT_EQ(stain.size(), dent.size() + 2) << "colour and roughness";
  EXPECT_TRUE(std::ranges::includes(all, dent));
  EXPECT_TRUE(all.contains("defects.dent.stain_roughness_deg"));
  EXPECT_TRUE(stain.contains("defects.stain.stain_roughness_deg"));
  EXPECT_FALSE(dent.contains("defects.dent.stain_roughness_deg"));
}

}  // namespace
}  // namespace glint
