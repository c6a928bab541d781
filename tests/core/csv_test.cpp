// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/csv.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/rng.h"

namespace glint {
namespace {

using ::testing::ElementsAre;

std::vector<std::vector<std::string>> texts_of(const std::string& text, char comment = '\0') {
  std::vector<std::vector<std::string>> rows;
  for (const CsvRow& row : parse_csv(text, "t.csv", comment)) {
    rows.emplace_back();
    for (const CsvField& field : row) {
      rows.back().push_back(field.text);
    }
  }
  return rows;
}

std::string csv_error(const std::string& text) {
  try {
    parse_csv(text, "t.csv");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ParseCsv, ReadsFieldsWithAndWithoutQuotes) {
  EXPECT_THAT(texts_of("a, b c ,\"d,\"\"e\"\"\n\",\r\n"),
              ElementsAre(ElementsAre("a", "b c", "d,\"e\"\n", "")));
  EXPECT_THAT(texts_of("\xEF\xBB\xBF"
                       "a\"b"),
              ElementsAre(ElementsAre("a\"b")));
  EXPECT_THAT(texts_of(",\n\"\" , \"x\" "), ElementsAre(ElementsAre("", ""), ElementsAre("", "x")));
}

TEST(ParseCsv, LeavesOutEmptyRowsAndComments) {
  EXPECT_THAT(texts_of("\n \t\r\n#1,2\n # \"\n1\n", '#'), ElementsAre(ElementsAre("1")));
  EXPECT_THAT(texts_of("#1,2\n"), ElementsAre(ElementsAre("#1", "2")));
  EXPECT_THAT(texts_of(""), ElementsAre());
}

TEST(ParseCsv, EveryFieldKnowsItsPlace) {
  const std::vector<CsvRow> rows = parse_csv("a,\"b\nb\", c\n\n  d", "t.csv");
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0][1].place.prefix(), "t.csv:1:3: ");
  EXPECT_EQ(rows[0][2].place.prefix(), "t.csv:2:5: ");
  EXPECT_EQ(rows[1][0].place.prefix(), "t.csv:4:3: ");
}

TEST(ParseCsv, RefusesQuotesThatDoNotHoldAField) {
  EXPECT_EQ(csv_error("a\nb,\"c,\n\n"), "t.csv:2:3: the quotes of a field are not closed");
  EXPECT_EQ(csv_error("\""), "t.csv:1:1: the quotes of a field are not closed");
  EXPECT_EQ(csv_error("\"\"\""), "t.csv:1:1: the quotes of a field are not closed");
  EXPECT_EQ(csv_error("1\n\"a\"b\n"), "t.csv:2:4: something follows the closing quote of a field");
}

TEST(CsvField, IsANumberOnlyAsAWhole) {
  EXPECT_EQ(CsvField{.text = "+1.5e3"}.number(), 1500.0);
  EXPECT_EQ(CsvField{.text = "-2"}.number(), -2.0);
  for (const char* text : {"", "+", "+-1", "1x", "1,5", "0x10", "1e999"}) {
    EXPECT_EQ((CsvField{.text = text, .place = {}}).number(), std::nullopt) << text;
  }
}

TEST(CsvRow, QuotesOnlyWhatNeedsIt) {
  EXPECT_EQ(csv_row_of("a b", 7, -0.25, std::size_t{3}, "say \"x\"", ""),
            "a b,7,-0.25,3,\"say \"\"x\"\"\",\n");
  EXPECT_EQ(csv_row_of("", "a,b", " a", 0.1F), ",\"a,b\",\" a\",0.10000000149011612\n");
}

// A spreadsheet takes what follows = + - @ for a formula; an apostrophe before it makes it a text.
TEST(CsvRow, WritesNoFormulas) {
  EXPECT_EQ(csv_row_of("=1+1", "+a", "-b", "@sum", -2, "'=x", "'y"),
            "'=1+1,'+a,'-b,'@sum,-2,''=x,'y\n");
  EXPECT_THAT(texts_of("'=1+1,\"'=a,b\",''=x,'y,''"),
              ElementsAre(ElementsAre("=1+1", "=a,b", "'=x", "'y", "''")));
  Rng rng(2, Stream::kTest, 0);
  const std::string letters = "'=+-@ab,\"";
  for (int i = 0; i < 1000; ++i) {
    std::string text;
    while (rng.uniform() < 0.8) {
      text += letters[rng.next_u32() % letters.size()];
    }
    const std::string row = csv_row_of("x", text);
    EXPECT_THAT(texts_of(row), ElementsAre(ElementsAre("x", text))) << row;
    EXPECT_EQ(std::string("=+-@").find(row.at(2)), std::string::npos) << row;
  }
}

// Texts of letters that need care, and doubles to the last bit.
TEST(CsvRow, ReadsBackAsTheSame) {
  Rng rng(1, Stream::kTest, 0);
  const std::string letters = "ab ,\"\n\r#\t;";
  for (int i = 0; i < 1000; ++i) {
    std::vector<std::string> texts = {"x"};
    for (int k = 0; k < 4; ++k) {
      std::string& text = texts.emplace_back();
      while (rng.uniform() < 0.7) {
        text += letters[rng.next_u32() % letters.size()];
      }
    }
    const double number = rng.uniform(-1e3, 1e3);
    const std::string row = csv_row(texts);
    EXPECT_THAT(texts_of(row), ElementsAre(texts)) << row;
    EXPECT_EQ(parse_csv(csv_row_of(number), "t.csv").at(0).at(0).number(), number);
  }
}

}  // namespace
}  // namespace glint
