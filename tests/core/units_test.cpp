// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/units.h"

#include <gtest/gtest.h>

namespace glint {
namespace {

TEST(WrittenUnit, IsTheSuffixOfTheKey) {
  EXPECT_EQ(written_unit("radius_mm"), "mm");
  EXPECT_EQ(written_unit("height_um"), "um");
  EXPECT_EQ(written_unit("wavelength_nm"), "nm");
  EXPECT_EQ(written_unit("tilt_deg"), "deg");
  EXPECT_EQ(written_unit("slope_mrad"), "mrad");
  EXPECT_EQ(written_unit("exposure_us"), "us");
  EXPECT_EQ(written_unit("move_ms"), "ms");
  EXPECT_EQ(written_unit("read_noise_e"), "e");
}

TEST(WrittenUnit, OfASpeedIsTheWholeOfIt) {
  EXPECT_EQ(written_unit("tool_speed_mm_s"), "mm_s");
  EXPECT_EQ(written_unit("joint_acceleration_deg_s2"), "deg_s2");
  EXPECT_DOUBLE_EQ(180.0 * internal_per_written("joint_speed_deg_s"), kPi);
  EXPECT_EQ(internal_per_written("tool_speed_mm_s"), 1.0);
  EXPECT_EQ(written_unit("settle_s"), "s");
  EXPECT_EQ(written_unit("mm_s"), "s");
}

TEST(WrittenUnit, IsEmptyForAKeyWithoutOne) {
  EXPECT_EQ(written_unit("duty"), "");
  EXPECT_EQ(written_unit("mm"), "");
  EXPECT_EQ(written_unit("crease_angle"), "");
  EXPECT_EQ(written_unit(""), "");
  EXPECT_EQ(written_unit("name_"), "");
}

// 180 deg = pi rad; 1000 um = 1 mm; 1000 mrad = 1 rad; 1000 ms = 1e6 us = 1 s.
TEST(InternalPerWritten, ConvertsToMmRadAndS) {
  EXPECT_DOUBLE_EQ(180.0 * internal_per_written("tilt_deg"), kPi);
  EXPECT_DOUBLE_EQ(1000.0 * internal_per_written("height_um"), 1.0);
  EXPECT_DOUBLE_EQ(1000.0 * internal_per_written("slope_mrad"), 1.0);
  EXPECT_DOUBLE_EQ(1000.0 * internal_per_written("move_ms"), 1.0);
  EXPECT_DOUBLE_EQ(1e6 * internal_per_written("exposure_us"), 1.0);
}

TEST(InternalPerWritten, LeavesInternalUnitsAlone) {
  for (const char* key : {"radius_mm", "tilt_rad", "wait_s", "wavelength_nm", "blur_px", "duty"}) {
    EXPECT_EQ(internal_per_written(key), 1.0) << key;
  }
}

}  // namespace
}  // namespace glint
