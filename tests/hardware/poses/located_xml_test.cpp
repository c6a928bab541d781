// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "hardware/poses/located_xml.h"

namespace glint {
namespace {

using testing::HasSubstr;

std::string xml_error(const std::string& text) {
  try {
    parse_located_xml(text, "a.xml");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

TEST(LocatedXml, ReadsElementsWithPlacesAndListsOfEqualNames) {
  const ConfigNode root = parse_located_xml(
      "<?xml version=\"1.0\"?>\n<!-- a > b --><root>\n  <px a='1>2'> 607.5 </px>\n"
      "  <m>1</m><m>two &lt;3</m>\n  <none/>\n</root>\n",
      "a.xml");
  EXPECT_EQ(root.find("px")->number, 607.5);
  EXPECT_EQ(root.find("px")->place.line, 3);
  EXPECT_EQ(root.find("px")->place.column, 16);
  ASSERT_EQ(root.find("m")->items.size(), 2U);
  EXPECT_EQ(root.find("m")->items[0].integer, 1);
  EXPECT_EQ(root.find("m")->items[1].text, "two <3");
  EXPECT_EQ(root.find("none")->text, "");
}

TEST(LocatedXml, RefusesWithPlace) {
  EXPECT_THAT(xml_error("<a>\n <b>1</c></a>"), HasSubstr("a.xml:2:8: closes c, but b is open"));
  EXPECT_THAT(xml_error("<a><b>1</b>"), HasSubstr("a.xml:1:12: "));
  EXPECT_THAT(xml_error("<a>1</a><b/>"), HasSubstr("a.xml:1:9: something follows"));
  EXPECT_THAT(xml_error("nothing"), HasSubstr("a.xml:1:1: expected an element"));
  EXPECT_THAT(xml_error("<!-- x"), HasSubstr("closing --> is missing"));
  std::string deep;
  for (int i = 0; i < 100; ++i) {
    deep += "<a>";
  }
  EXPECT_THAT(xml_error(deep), HasSubstr("deeper than 64"));
}

}  // namespace
}  // namespace glint
