// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the schema says; tests/cli/schema_test.mjs judges study files by it.
#include "studies/definition/study_schema.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "studies/definition/key_table.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

TEST(StudySchema, HasEveryTableAndNoOther) {
  const Json schema = study_schema();
  EXPECT_EQ(schema["properties"].size(), key_groups().size());
  for (const KeyGroup& group : key_groups()) {
    const Json& table = schema["properties"].at(std::string(group.name));
    EXPECT_EQ(table["description"], group.doc);
  }
  EXPECT_EQ(schema["additionalProperties"], false);
}

TEST(StudySchema, ANumberHasRangeUnitAndDefault) {
  const Json radius = study_schema()["definitions"]["tunnel"]["properties"]["radius_mm"];
  EXPECT_EQ(radius["type"], "number");
  EXPECT_EQ(radius.at("minimum"), 1.0);
  EXPECT_EQ(radius.at("maximum"), 1e5);
  EXPECT_TRUE(radius.at("default").is_number());
  EXPECT_THAT(radius.at("description").get<std::string>(),
              ::testing::HasSubstr("[mm; in [1, 100000]]"));
  const Json bits = study_schema()["properties"]["sensor"]["properties"]["bits"];
  EXPECT_EQ(bits["type"], "integer");
}

TEST(StudySchema, TablesOfTheUsersNamesHaveTheKeysOfTheirKind) {
  const Json tables = study_schema()["properties"];
  const Json& defect = tables["defects"]["additionalProperties"];
  EXPECT_TRUE(defect["properties"].contains("height_um"));
  EXPECT_EQ(defect["properties"]["height_um"]["anyOf"].size(), 2U) << "a number or [min, max]";
  EXPECT_EQ(defect["additionalProperties"], false);
  EXPECT_TRUE(tables["viewpoint"]["items"]["properties"].contains("position_mm"));
  const Json& source = tables["sorting"]["properties"]["sources"]["additionalProperties"];
  EXPECT_TRUE(source["properties"].contains("share"));
}

}  // namespace
}  // namespace glint
