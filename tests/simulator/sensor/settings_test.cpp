// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "core/config/key_writer.h"
#include "core/config/toml.h"
#include "simulator/sensor/sensor.h"

namespace glint {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<std::string> problems_of(std::string_view text, SensorSettings* read = nullptr) {
  const ConfigNode root = parse_toml(text, "scene.toml");
  std::vector<Problem> errors;
  KeyReader reader(root.find("sensor"), "sensor", errors);
  SensorSettings settings;
  visit_keys(reader, settings);
  reader.report_unknown();
  if (read != nullptr) {
    *read = settings;
  }
  return messages_of(errors);
}

TEST(SensorSettings, AreReadFromTheirTable) {
  SensorSettings settings;
  EXPECT_THAT(
      problems_of("[sensor]\ngain = 2.5\nbits = 12\nfull_well_e = 9000\ndark_e = 3\n", &settings),
      IsEmpty());
  EXPECT_EQ(settings.gain, 2.5);
  EXPECT_EQ(settings.bits, 12);
  EXPECT_EQ(settings.full_well_e, 9000.0);
  EXPECT_EQ(settings.blur_px, SensorSettings().blur_px);
}

TEST(SensorSettings, RefuseABitDepthThatNoCameraHas) {
  for (const int bits : {0, 8, 10, 12, 16}) {
    EXPECT_THAT(problems_of("[sensor]\nbits = " + std::to_string(bits)), IsEmpty());
  }
  for (const int bits : {-8, 1, 7, 9, 14, 17}) {
    const std::string text = std::to_string(bits);
    EXPECT_THAT(problems_of("[sensor]\nbits = " + text),
                ElementsAre(AllOf(HasSubstr("scene.toml:2:"),
                                  HasSubstr("is " + text + ", must be one of 0, 8, 10, 12, 16"))));
  }
}

// What `glint explain` prints.
TEST(SensorSettings, ListTheBitDepthsThatAreAllowed) {
  std::vector<KeyRow> rows;
  KeyLister lister("sensor", rows);
  SensorSettings settings;
  visit_keys(lister, settings);
  const auto bits = std::ranges::find(rows, "sensor.bits", &KeyRow::path);
  ASSERT_NE(bits, rows.end());
  EXPECT_EQ(bits->allowed, "one of 0, 8, 10, 12, 16");
}

TEST(SensorSettings, NeedTheFullWellForElectrons) {
  EXPECT_THAT(problems_of("[sensor]\nread_noise_e = 5\ndark_e = 1"),
              ElementsAre(HasSubstr("sensor.read_noise_e: is given in electrons and needs"),
                          HasSubstr("sensor.dark_e: is given in electrons and needs")));
}

TEST(SensorSettings, RefuseValuesOutOfRangeAndUnknownKeys) {
  EXPECT_THAT(problems_of("[sensor]\ngain = 0"),
              ElementsAre(HasSubstr("must be in [1e-06, 1000000]")));
  EXPECT_THAT(problems_of("[sensor]\ngian = 2"), ElementsAre(HasSubstr("gain")));
}

}  // namespace
}  // namespace glint
