// SPDX-License-Identifier: GPL-3.0-or-later
//
// Changes that move edges by up to a twentieth of the picture's width and more: causes are right or
// they are not told.
#include <cstdlib>

#include "core/rng.h"
#include "tests/cli/changes/known_changes.h"

namespace glint::test {
namespace {

constexpr int kWidthPx = 400;
constexpr double kDepth_mm = 146.0;  ///< of the gear's middle

double focal_px() {
  return 12.0 / (0.0138 * 612.0 / kWidthPx);
}

/// A shift of 5 to 25 px, a turn in the picture of 1 to 6 degrees or a focal length that is 2 to 6
/// % off, either way; alone or, every third case, a shift and one of the others.
std::vector<Change> drawn_large(int index) {
  Rng rng(78, Stream::kTest, static_cast<std::uint64_t>(index));
  const auto either = [&](double low, double high) {
    return rng.uniform(low, high) * (rng.uniform() < 0.5 ? -1.0 : 1.0);
  };
  const double mm_per_px = kDepth_mm / focal_px();
  const Change across = {rng.uniform() < 0.5 ? CauseParameter::kShiftX : CauseParameter::kShiftY,
                         mm_per_px * either(5.0, 25.0)};
  const Change turn = {CauseParameter::kTurnZ, either(1.0, 6.0) * kRadPerDeg};
  if (index % 8 >= 6) {
    const Change far = {across.parameter, mm_per_px * either(30.0, 70.0)};
    const Change beside = {
        index % 8 == 6 ? CauseParameter::kTurnZ : CauseParameter::kFocalLength,
        index % 8 == 6 ? either(6.0, 9.5) * kRadPerDeg : focal_px() * either(0.06, 0.12)};
    return {far, beside};
  }
  const Change focal = {CauseParameter::kFocalLength, focal_px() * either(0.02, 0.06)};
  switch (index % 8) {
    case 0:
    case 3:
      return {across};
    case 1:
      return {turn};
    case 2:
      return {across, turn};
    case 4:
      return {focal};
    default:
      return {across, focal};
  }
}

/// What a change would be were it the other parameter of its group, to first order.
double as_other(const Change& change, const std::string& name) {
  const double px_per_mm = focal_px() / kDepth_mm;
  if (name == "centre_x" || name == "centre_y") {
    return change.value * px_per_mm;
  }
  if (name == "distance") {
    return -change.value * kDepth_mm / focal_px();
  }
  return told_per_inner(change.parameter) * change.value;
}

/// The value that a cause should have, 0 for what did not change.
double truth_of(const nlohmann::json& cause, const std::vector<Change>& changes) {
  for (const Change& change : changes) {
    if (!ChangedGear::find(nlohmann::json::array({cause}), change.parameter).is_null()) {
      return as_other(change, cause["name"].get<std::string>());
    }
  }
  return 0.0;
}

std::string text_of(const std::vector<Change>& changes) {
  std::string text;
  for (const Change& change : changes) {
    text += fmt::format(
        "{} {:.4g} ", name_of(change.parameter), told_per_inner(change.parameter) * change.value);
  }
  return text;
}

/// Asserts that what was said of edges is right. @returns how many causes were said and are true
std::size_t check_said(const nlohmann::json& causes,
                       const std::vector<Change>& changes,
                       std::string& text) {
  std::size_t found = 0;
  for (const nlohmann::json& cause : causes) {
    if (cause["of"] != "edges") {
      continue;
    }
    const double truth = truth_of(cause, changes);
    const double value = cause["value"].get<double>();
    const double sigma = cause["sigma"].get<double>();
    // Of a group the value is that of another parameter, to first order.
    const double order = cause.contains("group") ? 0.05 * std::abs(truth) : 0.0;
    text += fmt::format("| {} {:.4g} +- {:.2g} for {:.4g}{} ",
                        cause["name"].get<std::string>(),
                        value,
                        sigma,
                        truth,
                        cause.contains("group") ? " (group)" : "");
    EXPECT_LE(std::abs(value - truth), 4.0 * sigma + order) << text;
    found += truth != 0.0 ? 1U : 0U;
  }
  return found;
}

TEST(LargeChanges, AreToldRightlyOrNotAtAll) {
  const char* given = std::getenv("GLINT_LARGE_CASES");
  const int cases = given != nullptr ? std::atoi(given) : 16;
  ChangedGear gear(kWidthPx, 8);
  int silent = 0;
  int complete = 0;
  for (int i = 0; i < cases; ++i) {
    const std::vector<Change> changes = drawn_large(i);
    const nlohmann::json causes = gear.causes_of(changes, 100 + i);
    std::string text = text_of(changes);
    const std::size_t found = check_said(causes, changes, text);
    silent += found == 0 ? 1 : 0;
    complete += found == changes.size() ? 1 : 0;
    std::printf("%s %s\n", text.c_str(), gear.last_pair()["notes"].dump().c_str());
  }
  std::printf("%d cases: %d complete, %d silent\n", cases, complete, silent);
  EXPECT_GE(complete, cases * 2 / 3);
}

// Where edges are not looked for along the simulated outline, nearest ones may be another tooth's.
TEST(LargeChanges, WithoutTheSimulatedOutlineAreNotTold) {
  ChangedGear gear(kWidthPx, 8);
  const std::vector<Change> shift = {{CauseParameter::kShiftX, 18.0 * kDepth_mm / focal_px()}};
  const nlohmann::json causes = gear.causes_of(shift, 3, {"--outline", "threshold"});
  for (const nlohmann::json& cause : causes) {
    EXPECT_NE(cause["of"], "edges") << gear.last();
  }
  EXPECT_NE(gear.last_pair()["notes"].dump().find("no cause is named"), std::string::npos)
      << gear.last_pair()["notes"];
}

/// Whether a shift by a share of the picture's width is told where edges are matched by nearness
/// alone; what is told is right.
bool is_shift_told(ChangedGear& gear, int width_px, double share) {
  const double px_per_mm = focal_px() * width_px / kWidthPx / kDepth_mm;
  const Change shift = {CauseParameter::kShiftX, share * width_px / px_per_mm};
  const nlohmann::json causes = gear.causes_of({&shift, 1}, 3, {"--outline", "threshold"});
  const nlohmann::json found = ChangedGear::find(causes, shift.parameter);
  std::printf("%d px, shift %.2f %%: %s %s\n",
              width_px,
              100.0 * share,
              gear.last().c_str(),
              gear.last_pair()["notes"].dump().c_str());
  const bool is_withheld =
      gear.last_pair()["notes"].dump().find("no cause is named") != std::string::npos;
  EXPECT_EQ(found.is_null(), is_withheld);
  if (!found.is_null()) {
    const double off = std::abs(found["value"].get<double>() - shift.value);
    EXPECT_LT(off, 4.0 * found["sigma"].get<double>()) << gear.last();
  }
  return !found.is_null();
}

// A shift by one share of the width means the same in a small picture and in a large one.
TEST(LargeChanges, MeanTheSameAtEverySize) {
  for (const int width_px : {306, 1224}) {
    ChangedGear gear(width_px, 8);
    EXPECT_TRUE(is_shift_told(gear, width_px, 0.006)) << width_px;
    EXPECT_FALSE(is_shift_told(gear, width_px, 0.014)) << width_px;
  }
}

}  // namespace
}  // namespace glint::test
