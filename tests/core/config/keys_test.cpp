// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/keys.h"

#include <array>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/key_digest.h"
#include "core/config/key_writer.h"
#include "core/config/toml.h"
#include "core/file.h"
#include "core/rng.h"
#include "core/units.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

enum class Shape { kFlat, kEllipse };

constexpr std::array<std::string_view, 2> kShapeNames = {"flat", "ellipse"};

struct Slot {
  double width_mm = 4.0;
  bool is_open = true;
};

struct Lamp {
  double radius_mm = 150.0;
  double tilt_rad = kPi / 2;
  double height_mm = 0.02;
  int positions = 24;
  Shape shape = Shape::kFlat;
  std::string name = "lamp";
  std::filesystem::path file;
  std::vector<double> angles_rad = {0.0, kPi};
  Slot slot;
};

void visit_slot(KeyVisitor& keys, Slot& slot) {
  keys.number("width_mm", slot.width_mm, Range::positive(), "Width of the slot.");
  keys.boolean("open", slot.is_open, "Whether there is one.");
}

void visit_lamp(KeyVisitor& keys, Lamp& lamp) {
  keys.number("radius_mm", lamp.radius_mm, Range::positive(), "Radius.");
  keys.number("tilt_deg", lamp.tilt_rad, Range::between(-180, 180), "Tilt.");
  keys.number("height_um", lamp.height_mm, {}, "Height.");
  keys.integer("positions", lamp.positions, Range::at_least(1), "Positions.");
  keys.choice("shape", lamp.shape, kShapeNames, "Shape.");
  keys.text("name", lamp.name, "Name.");
  keys.file("file", lamp.file, "Mesh.");
  keys.numbers(
      "angles_deg", lamp.angles_rad, {.min = 1, .max = 3}, Range::between(0, 360), "Angles.");
  keys.table(
      "slot", [&](KeyVisitor& inner) { visit_slot(inner, lamp.slot); }, "Slot.");
  keys.require(lamp.slot.width_mm < lamp.radius_mm, "slot", "must be narrower than the radius");
}

struct ReadResult {
  Lamp lamp;
  std::vector<Problem> errors;
};

ReadResult read_lamp(const ConfigNode& root) {
  ReadResult result;
  KeyReader reader(root.find("lamp"), "lamp", result.errors);
  visit_lamp(reader, result.lamp);
  reader.report_unknown();
  return result;
}

ReadResult read_lamp(const std::string& text) {
  return read_lamp(parse_toml("[lamp]\n" + text, "s.toml"));
}

std::vector<std::string> errors_of(const std::string& text) {
  return messages_of(read_lamp(text).errors);
}

TEST(Range, SaysWhatIsAllowed) {
  EXPECT_EQ(Range::positive().text(), "> 0");
  EXPECT_EQ(Range::at_least(1).text(), ">= 1");
  EXPECT_EQ(Range::between(0, 0.5).text(), "in [0, 0.5]");
  EXPECT_EQ(Range::between(-1e5, 2.5).text(), "in [-100000, 2.5]");
  EXPECT_EQ(Range::between(1e-6, 1e9).text(), "in [1e-06, 1e+09]");
  EXPECT_EQ((Range{.min = 0, .max = 1, .min_excluded = true}).text(), "in (0, 1]");
  EXPECT_EQ((Range{.max = 3}).text(), "<= 3");
  EXPECT_EQ(Range{}.text(), "any");
  constexpr std::array<int, 3> kOdd = {1, 3, 5};
  EXPECT_EQ(Range::one_of(kOdd).text(), "one of 1, 3, 5");
}

TEST(Range, OfSomeNumbersContainsNoOther) {
  constexpr std::array<int, 3> kOdd = {-1, 3, 5};
  const Range odd = Range::one_of(kOdd);
  for (const double value : {-1.0, 3.0, 5.0}) {
    EXPECT_TRUE(odd.contains(value)) << value;
  }
  for (const double value : {-2.0, 0.0, 3.5, 4.0, 6.0}) {
    EXPECT_FALSE(odd.contains(value)) << value;
  }
}

TEST(Range, ContainsItsEndsUnlessExcluded) {
  EXPECT_TRUE(Range::between(0, 1).contains(0));
  EXPECT_TRUE(Range::between(0, 1).contains(1));
  EXPECT_FALSE(Range::between(0, 1).contains(1.0000001));
  EXPECT_FALSE(Range::positive().contains(0));
  EXPECT_TRUE(Range::positive().contains(1e-300));
  EXPECT_FALSE(Range::between(0, 1).contains(std::nan("")));
}

// 90 deg = pi/2 rad; 20 um = 0.02 mm; the integer 12 is a number too.
TEST(KeyReader, ConvertsUnitsOnce) {
  const ReadResult result =
      read_lamp("radius_mm = 12\ntilt_deg = 45.0\nheight_um = 30\nangles_deg = [90, 180]\n");
  EXPECT_THAT(result.errors, IsEmpty());
  EXPECT_EQ(result.lamp.radius_mm, 12.0);
  EXPECT_DOUBLE_EQ(result.lamp.tilt_rad, kPi / 4);
  EXPECT_DOUBLE_EQ(result.lamp.height_mm, 0.03);
  EXPECT_THAT(result.lamp.angles_rad,
              ElementsAre(testing::DoubleEq(kPi / 2), testing::DoubleEq(kPi)));
}

TEST(KeyReader, KeepsDefaultsForWhatIsAbsent) {
  const ReadResult result = read_lamp("positions = 8\nshape = \"ellipse\"\nname = \"x\"\n");
  EXPECT_THAT(result.errors, IsEmpty());
  EXPECT_EQ(result.lamp.positions, 8);
  EXPECT_EQ(result.lamp.shape, Shape::kEllipse);
  EXPECT_EQ(result.lamp.name, "x");
  EXPECT_EQ(result.lamp.radius_mm, 150.0);
  EXPECT_EQ(result.lamp.slot.width_mm, 4.0);
  EXPECT_THAT(read_lamp(ConfigNode::table()).errors, IsEmpty());
}

TEST(KeyReader, ReadsNestedTables) {
  const ReadResult result = read_lamp("slot = { width_mm = 7.5, open = false }\n");
  EXPECT_THAT(result.errors, IsEmpty());
  EXPECT_EQ(result.lamp.slot.width_mm, 7.5);
  EXPECT_FALSE(result.lamp.slot.is_open);
}

TEST(KeyReader, NamesTheNearestKnownKey) {
  EXPECT_THAT(errors_of("name = \"x\"\nradus_mm = 3\n"),
              ElementsAre("s.toml:3:1: lamp.radus_mm: unknown key, "
                          "the nearest known one is \"radius_mm\""));
  EXPECT_THAT(errors_of("[lamp.slot]\n  widht_mm = 3\n"),
              ElementsAre("s.toml:3:3: lamp.slot.widht_mm: unknown key, "
                          "the nearest known one is \"width_mm\""));
  // angle -> name or file takes 3 edits, angle -> angles_deg 5; but it holds the whole name.
  EXPECT_THAT(errors_of("angle = 3\n"), ElementsAre(::testing::HasSubstr("\"angles_deg\"")));
}

// Ranges are in the written unit: 200 deg is told as 200, not as 3.49 rad.
TEST(KeyReader, SaysWhatIsOutOfRange) {
  EXPECT_THAT(errors_of("radius_mm = 0\n"),
              ElementsAre("s.toml:2:1: lamp.radius_mm: is 0, must be > 0"));
  EXPECT_THAT(errors_of("tilt_deg = 200.5\n"),
              ElementsAre("s.toml:2:1: lamp.tilt_deg: is 200.5, must be in [-180, 180]"));
  EXPECT_THAT(errors_of("positions = 0\n"),
              ElementsAre("s.toml:2:1: lamp.positions: is 0, must be >= 1"));
  EXPECT_THAT(errors_of("height_um = nan\n"),
              ElementsAre("s.toml:2:1: lamp.height_um: is nan, must be a finite number"));
  EXPECT_THAT(errors_of("radius_mm = inf\n"),
              ElementsAre("s.toml:2:1: lamp.radius_mm: is inf, must be a finite number"));
}

TEST(KeyReader, SaysWhichKindOfValueIsWanted) {
  EXPECT_THAT(errors_of("radius_mm = \"wide\"\n"),
              ElementsAre("s.toml:2:1: lamp.radius_mm: must be a number, > 0"));
  EXPECT_THAT(errors_of("positions = 2.5\n"),
              ElementsAre("s.toml:2:1: lamp.positions: is 2.5, must be a whole number of at most "
                          "2e9"));
  EXPECT_THAT(errors_of("name = 3\n"),
              ElementsAre("s.toml:2:1: lamp.name: must be a text in quotes"));
  EXPECT_THAT(errors_of("file = 3\n"),
              ElementsAre("s.toml:2:1: lamp.file: must be a file name in quotes"));
  EXPECT_THAT(errors_of("slot = { open = 1 }\n"),
              ElementsAre("s.toml:2:10: lamp.slot.open: must be true or false"));
  EXPECT_THAT(errors_of("slot = 4\n"),
              ElementsAre("s.toml:2:1: lamp.slot: must be a table, like [lamp.slot]"));
}

TEST(KeyReader, ListsTheChoices) {
  EXPECT_THAT(errors_of("shape = \"round\"\n"),
              ElementsAre("s.toml:2:1: lamp.shape: is \"round\", must be one of \"flat\", "
                          "\"ellipse\""));
  EXPECT_THAT(errors_of("shape = 3\n"),
              ElementsAre("s.toml:2:1: lamp.shape: is 3, must be one of \"flat\", \"ellipse\""));
}

TEST(KeyReader, CountsTheNumbersOfAnArray) {
  const std::string wrong_count = "s.toml:2:1: lamp.angles_deg: must be an array of 1 to 3 numbers";
  EXPECT_THAT(errors_of("angles_deg = []\n"), ElementsAre(wrong_count));
  EXPECT_THAT(errors_of("angles_deg = [1, 2, 3, 4]\n"), ElementsAre(wrong_count));
  EXPECT_THAT(errors_of("angles_deg = 5\n"), ElementsAre(wrong_count));
  EXPECT_THAT(errors_of("angles_deg = [1, 400]\n"),
              ElementsAre("s.toml:2:18: lamp.angles_deg: is 400, must be in [0, 360]"));
  EXPECT_THAT(errors_of("angles_deg = [\"a\"]\n"),
              ElementsAre("s.toml:2:15: lamp.angles_deg: must be a number, in [0, 360]"));
}

TEST(KeyReader, FindsFilesBesideTheStudy) {
  const TemporaryFolder folder;
  write_file(folder / "part.stl", "solid");
  const std::string study = (folder / "s.toml").string();
  const ReadResult found = read_lamp(parse_toml("[lamp]\nfile = \"part.stl\"\n", study));
  EXPECT_THAT(found.errors, IsEmpty());
  EXPECT_EQ(found.lamp.file, folder / "part.stl");
  const ReadResult missing = read_lamp(parse_toml("[lamp]\nfile = \"gone.stl\"\n", study));
  EXPECT_THAT(messages_of(missing.errors),
              ElementsAre(study + ":2:1: lamp.file: the file " + (folder / "gone.stl").string() +
                          " does not exist"));
}

TEST(KeyReader, ChecksConditionsBetweenKeys) {
  EXPECT_THAT(errors_of("radius_mm = 3\n[lamp.slot]\nwidth_mm = 5\n"),
              ElementsAre("s.toml:3:7: lamp.slot: must be narrower than the radius"));
}

// The program asks for kind, key and place, so that texts may be reworded.
TEST(KeyReader, TellsTheKindTheKeyAndThePlaceOfAProblem) {
  using Found = Problem::Kind;

  const struct {
    const char* toml;
    Found kind;
    const char* key;
  } cases[] = {{"radius_mm = 0\n", Found::kOutOfRange, "lamp.radius_mm"},
               {"radius_mm = nan\n", Found::kOutOfRange, "lamp.radius_mm"},
               {"positions = 0\n", Found::kOutOfRange, "lamp.positions"},
               {"positions = 2.5\n", Found::kOutOfRange, "lamp.positions"},
               {"shape = \"round\"\n", Found::kOutOfRange, "lamp.shape"},
               {"angles_deg = [400]\n", Found::kOutOfRange, "lamp.angles_deg"},
               {"radius_mm = \"wide\"\n", Found::kWrongType, "lamp.radius_mm"},
               {"name = 3\n", Found::kWrongType, "lamp.name"},
               {"slot = 4\n", Found::kWrongType, "lamp.slot"},
               {"slot = { open = 1 }\n", Found::kWrongType, "lamp.slot.open"},
               {"angles_deg = []\n", Found::kWrongType, "lamp.angles_deg"},
               {"slot = { width_mm = 1e6 }\n", Found::kRelation, "lamp.slot"},
               {"foo = 1\n", Found::kUnknownKey, "lamp.foo"}};

  for (const auto& [toml, kind, key] : cases) {
    const std::vector<Problem> problems = read_lamp(toml).errors;
    ASSERT_EQ(problems.size(), 1U) << toml;
    EXPECT_EQ(problems[0].kind, kind) << toml;
    EXPECT_EQ(problems[0].key, key) << toml;
    EXPECT_EQ(problems[0].place.line, 2) << toml;
  }
}

TEST(KeyReader, ReportsEveryProblemInOnePass) {
  EXPECT_THAT(errors_of("radius_mm = -1\nshape = \"round\"\nfoo = 1\npositions = 1.5\n"),
              ElementsAre("s.toml:2:1: lamp.radius_mm: is -1, must be > 0",
                          "s.toml:5:1: lamp.positions: is 1.5, must be a whole number of at most "
                          "2e9",
                          "s.toml:3:1: lamp.shape: is \"round\", must be one of \"flat\", "
                          "\"ellipse\"",
                          "s.toml:4:1: lamp.foo: unknown key, the nearest known one is \"file\""));
}

TEST(KeyReader, KeepsDefaultsForWhatIsWrong) {
  const ReadResult result = read_lamp("radius_mm = -1\nshape = \"round\"\nangles_deg = [1, 400]\n");
  EXPECT_EQ(result.errors.size(), 3U);
  EXPECT_EQ(result.lamp.radius_mm, 150.0);
  EXPECT_EQ(result.lamp.shape, Shape::kFlat);
  EXPECT_EQ(result.lamp.angles_rad.size(), 2U);
}

TEST(KeyReader, KnowsWhatIsGiven) {
  const ConfigNode root = parse_toml("a = 1\n", "s.toml");
  std::vector<Problem> errors;
  const KeyReader reader(&root, "", errors);
  EXPECT_TRUE(reader.is_given("a"));
  EXPECT_FALSE(reader.is_given("b"));
  EXPECT_FALSE(KeyReader(nullptr, "", errors).is_given("a"));
}

Interval interval_of(const std::string& toml, std::vector<Problem>& errors) {
  const ConfigNode root = parse_toml(toml, "d.toml");
  Interval value(1.0, 2.0);
  KeyReader reader(&root, "", errors);
  reader.interval("height_um", value, Range::positive(), "Height.");
  return value;
}

TEST(KeyReader, TakesANumberOrARangeForAnInterval) {
  std::vector<Problem> errors;
  EXPECT_DOUBLE_EQ(interval_of("height_um = 4", errors).min, 4e-3);
  EXPECT_TRUE(interval_of("height_um = 4", errors).is_fixed());
  EXPECT_DOUBLE_EQ(interval_of("height_um = [4, 8]", errors).max, 8e-3);
  EXPECT_DOUBLE_EQ(interval_of("height_um = [4, 8]", errors).at(0.25), 5e-3);
  EXPECT_DOUBLE_EQ(interval_of("", errors).max, 2.0);
  EXPECT_THAT(errors, IsEmpty());
}

TEST(KeyReader, RefusesAnIntervalThatIsNone) {
  std::vector<Problem> errors;
  for (const char* toml : {"height_um = [8, 4]",
                           "height_um = [4]",
                           "height_um = []",
                           "height_um = \"big\"",
                           "height_um = [0, 4]",
                           "height_um = [1, nan]"}) {
    errors.clear();
    EXPECT_DOUBLE_EQ(interval_of(toml, errors).max, 2.0) << toml;
    EXPECT_EQ(errors.size(), 1U) << toml;
  }
}

TEST(KeyWriter, WritesAnIntervalAsItIsRead) {
  for (Interval value : {Interval(4e-3), Interval(4e-3, 8e-3)}) {
    ConfigNode table = ConfigNode::table();
    KeyWriter writer(table);
    writer.interval("height_um", value, Range::positive(), "Height.");
    std::vector<Problem> errors;
    const Interval again = interval_of(to_toml(table), errors);
    EXPECT_EQ(again.min, value.min);
    EXPECT_EQ(again.max, value.max);
  }
}

TEST(ThrowIfAny, ThrowsAllLinesOrNothing) {
  EXPECT_NO_THROW(throw_if_any({}));
  EXPECT_EQ(text_thrown_by<ConfigError>([] {
              throw_if_any({{.text = "one"}, {.text = "two"}});
            }),
            "one\ntwo");
}

TEST(KeyLister, ListsEveryKeyWithItsUnitAndDefault) {
  std::vector<KeyRow> rows;
  KeyLister lister("lamp", rows);
  Lamp lamp;
  visit_lamp(lister, lamp);
  std::vector<std::string> lines;
  lines.reserve(rows.size());
  for (const KeyRow& row : rows) {
    lines.push_back(row.path + "|" + row.kind + "|" + row.unit + "|" + row.allowed + "|" +
                    row.default_text + "|" + row.doc);
  }
  EXPECT_THAT(lines,
              ElementsAre("lamp.radius_mm|number|mm|> 0|150|Radius.",
                          "lamp.tilt_deg|number|deg|in [-180, 180]|90|Tilt.",
                          "lamp.height_um|number|um|any|20|Height.",
                          "lamp.positions|integer||>= 1|24|Positions.",
                          "lamp.shape|choice||\"flat\", \"ellipse\"|\"flat\"|Shape.",
                          "lamp.name|text||any|\"lamp\"|Name.",
                          "lamp.file|file||an existing file|\"\"|Mesh.",
                          "lamp.angles_deg|numbers|deg|1 to 3 numbers, each in [0, 360]|[0, "
                          "180]|Angles.",
                          "lamp.slot.width_mm|number|mm|> 0|4|Width of the slot.",
                          "lamp.slot.open|boolean||true or false|true|Whether there is one."));
}

TEST(KeyWriter, WritesEveryKeyInWrittenUnits) {
  ConfigNode table = ConfigNode::table();
  KeyWriter writer(table);
  Lamp lamp;
  visit_lamp(writer, lamp);
  EXPECT_EQ(to_toml(table),
            "radius_mm = 150.0\ntilt_deg = 90.0\nheight_um = 20.0\npositions = 24\n"
            "shape = \"flat\"\nname = \"lamp\"\nfile = \"\"\nangles_deg = [0.0, 180.0]\n"
            "\n[slot]\nwidth_mm = 4.0\nopen = true\n");
}

Lamp written_and_read(Lamp lamp, std::vector<Problem>& errors) {
  ConfigNode root = ConfigNode::table();
  ConfigNode table = ConfigNode::table();
  KeyWriter writer(table);
  visit_lamp(writer, lamp);
  set_path(root, "lamp", table);
  const ReadResult result = read_lamp(parse_toml(to_toml(root), "resolved.toml"));
  errors = result.errors;
  return result.lamp;
}

/// A lamp as a reader makes it from random numbers in written units.
Lamp random_lamp(Rng& rng) {
  Lamp lamp;
  lamp.radius_mm = rng.uniform(10, 1000);
  lamp.tilt_rad = rng.uniform(-180, 180) * internal_per_written("tilt_deg");
  lamp.height_mm = rng.normal() * internal_per_written("height_um");
  lamp.positions = static_cast<int>(1 + rng.next_u32() % 1000000);
  lamp.shape = rng.uniform() < 0.5 ? Shape::kFlat : Shape::kEllipse;
  lamp.angles_rad.assign(1 + rng.next_u32() % 3, 0.0);
  for (double& angle_rad : lamp.angles_rad) {
    angle_rad = rng.uniform(0, 360) * internal_per_written("angles_deg");
  }
  lamp.slot = {.width_mm = rng.uniform(0.1, 5), .is_open = rng.uniform() < 0.5};
  return lamp;
}

TEST(KeyWriter, ReadsBackBitForBit) {
  for (std::uint64_t i = 0; i < 2000; ++i) {
    Rng rng(41, Stream::kTest, i);
    const Lamp lamp = random_lamp(rng);
    std::vector<Problem> errors;
    const Lamp read = written_and_read(lamp, errors);
    ASSERT_THAT(errors, IsEmpty());
    ASSERT_EQ(read.radius_mm, lamp.radius_mm);
    ASSERT_EQ(read.tilt_rad, lamp.tilt_rad) << "case " << i;
    ASSERT_EQ(read.height_mm, lamp.height_mm) << "case " << i;
    ASSERT_EQ(read.positions, lamp.positions);
    ASSERT_EQ(read.shape, lamp.shape);
    ASSERT_EQ(read.angles_rad, lamp.angles_rad) << "case " << i;
    ASSERT_EQ(read.slot.width_mm, lamp.slot.width_mm);
    ASSERT_EQ(read.slot.is_open, lamp.slot.is_open);
  }
}

TEST(KeyWriter, WritesValuesTooSmallToBeRoundedAsTheyAre) {
  Lamp lamp;
  lamp.height_mm = 1e-320;
  lamp.tilt_rad = 5e-324;
  std::vector<Problem> errors;
  EXPECT_NEAR(written_and_read(lamp, errors).height_mm, 1e-320, 1e-322);
  EXPECT_THAT(errors, IsEmpty());
}

std::string digest_of(Lamp lamp) {
  std::string bytes;
  KeyDigest digest(bytes);
  visit_lamp(digest, lamp);
  return bytes;
}

TEST(KeyDigest, DiffersWhereAnyKeyDoesAndNowhereElse) {
  const std::string plain = digest_of({});
  EXPECT_EQ(digest_of({}), plain);
  EXPECT_NE(digest_of({.radius_mm = std::nextafter(150.0, 151.0)}), plain);
  EXPECT_NE(digest_of({.positions = 25}), plain);
  EXPECT_NE(digest_of({.shape = Shape::kEllipse}), plain);
  EXPECT_NE(digest_of({.name = "lamp2"}), plain);
  EXPECT_NE(digest_of({.file = "mesh.stl"}), plain);
  EXPECT_NE(digest_of({.angles_rad = {0.0}}), plain);
  EXPECT_NE(digest_of({.slot = {.is_open = false}}), plain);
  EXPECT_NE(digest_of({.name = "ab", .file = "c"}), digest_of({.name = "a", .file = "bc"}));
  EXPECT_EQ(digest_of({.height_mm = -0.0}), digest_of({.height_mm = 0.0}));
}

}  // namespace
}  // namespace glint
