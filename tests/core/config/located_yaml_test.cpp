// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/located_yaml.h"

#include <cmath>

#include <gmock/gmock.h>

namespace glint {
namespace {

using testing::HasSubstr;

std::string yaml_error(const std::string& text) {
  try {
    parse_located_yaml(text, "a.yaml");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

TEST(LocatedYaml, ReadsWhatViSPWritesWithPlaces) {
  const ConfigNode root =
      parse_located_yaml("rows: 2\ncols: 1\ndata: \n  - [0.335091]\n  - [-3.01226]\n", "a.yaml");
  EXPECT_EQ(root.find("rows")->integer, 2);
  const ConfigNode& second = root.find("data")->items[1].items[0];
  EXPECT_EQ(second.number, -3.01226);
  EXPECT_EQ(second.place.line, 5);
  EXPECT_EQ(second.place.column, 6);
}

TEST(LocatedYaml, ReadsOpenCvsHeadAndItsMatrices) {
  const ConfigNode root = parse_located_yaml(
      "%YAML:1.0\n---\nK: !!opencv-matrix\n   rows: 1\n   cols: 2\n   dt: d\n   data: [ 1., .Nan "
      "]\n",
      "a.yaml");
  const ConfigNode& data = *root.find("K")->find("data");
  EXPECT_EQ(data.items[0].number, 1.0);
  EXPECT_TRUE(std::isnan(data.items[1].number));
  EXPECT_EQ(root.find("K")->find("dt")->text, "d");
}

TEST(LocatedYaml, RefusesWithPlace) {
  EXPECT_THAT(yaml_error("a: [1, 2\nb: 3\n"), HasSubstr("a.yaml:2:"));
  EXPECT_THAT(yaml_error("a: 1\na: 2\n"), HasSubstr("a.yaml:2:1: a: appears twice"));
  EXPECT_THAT(yaml_error("a:\n"), HasSubstr("found no value"));
  EXPECT_THAT(yaml_error("a: &x 1\nb: *x\n"), HasSubstr("a.yaml:2:4: refers to an anchor"));
  EXPECT_THAT(yaml_error(""), HasSubstr("holds no value"));
  EXPECT_THAT(yaml_error("a: 1\n---\nb: 2\n"), HasSubstr("second document"));
  EXPECT_THAT(yaml_error(std::string(100, '[')), HasSubstr("deeper than 64"));
}

TEST(LocatedYaml, LeavesNamesWithoutAValueOutWhereThatIsAskedFor) {
  const ConfigNode root =
      parse_located_yaml("a:\nb: ~\nc: null\nd: \"\"\n", "a.yaml", YamlNulls::kLeftOut);
  EXPECT_EQ(root.names, std::vector<std::string>{"d"});
}

}  // namespace
}  // namespace glint
