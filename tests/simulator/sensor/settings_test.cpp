// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "core/config/toml.h"
#include "simulator/sensor/sensor.h"

namespace glint {
namespace {

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
  EXPECT_THAT(problems_of("[sensor]\nbits = 9"), ElementsAre(HasSubstr("scene.toml:2:")));
  EXPECT_THAT(problems_of("[sensor]\nbits = 9"), ElementsAre(HasSubstr("8, 10, 12, 16")));
}

TEST(SensorSettings, NeedTheFullWellForElectrons) {
  EXPECT_THAT(problems_of("[sensor]\nread_noise_e = 5\ndark_e = 1"),
              ElementsAre(HasSubstr("sensor.read_noise_e: is given in electrons and needs"),
                          HasSubstr("sensor.dark_e: is given in electrons and needs")));
}

TEST(SensorSettings, RefuseValuesOutOfRangeAndUnknownKeys) {
  EXPECT_THAT(problems_of("[sensor]\ngain = 0"),
              ElementsAre(HasSubstr("must be in [1e-06, 1e+06]")));
  EXPECT_THAT(problems_of("[sensor]\ngian = 2"), ElementsAre(HasSubstr("gain")));
}

}  // namespace
}  // namespace glint
