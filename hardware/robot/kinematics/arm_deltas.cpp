// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/kinematics/arm_deltas.h"

#include <algorithm>

#include "core/config/toml.h"
#include "core/file.h"

namespace glint {
namespace {

constexpr const char* kTable = "arm_deltas";

}  // namespace

bool ArmDeltas::is_zero() const {
  const auto all_zero = [](const std::vector<double>& values) {
    return std::ranges::all_of(values, [](double value) { return value == 0.0; });
  };
  return all_zero(theta_rad) && all_zero(a_mm) && all_zero(d_mm) && all_zero(alpha_rad);
}

void visit_keys(KeyVisitor& keys, ArmDeltas& deltas) {
  constexpr Count kSix = {.min = 6, .max = 6};
  keys.choice("model", deltas.model, kArmModels, "the arm that was calibrated");
  keys.text("serial_number", deltas.serial_number, "of the arm, for people");
  keys.numbers("delta_theta_rad",
               deltas.theta_rad,
               kSix,
               Range::between(-0.2, 0.2),
               "added to the angle of each joint");
  keys.numbers(
      "delta_a_mm", deltas.a_mm, kSix, Range::between(-1000, 1000), "added to a of each row");
  keys.numbers(
      "delta_d_mm", deltas.d_mm, kSix, Range::between(-1000, 1000), "added to d of each row");
  keys.numbers("delta_alpha_rad",
               deltas.alpha_rad,
               kSix,
               Range::between(-0.2, 0.2),
               "added to alpha of each row");
}

DhTable calibrated_table(ArmModel model, const ArmDeltas& deltas) {
  DhTable table = nominal_table(model);
  for (std::size_t i = 0; i < table.size(); ++i) {
    table[i].theta_rad += deltas.theta_rad.at(i);
    table[i].a_mm += deltas.a_mm.at(i);
    table[i].d_mm += deltas.d_mm.at(i);
    table[i].alpha_rad += deltas.alpha_rad.at(i);
  }
  return table;
}

ArmDeltas parse_arm_deltas(std::string_view text, const std::string& file) {
  const ConfigNode root = parse_toml(text, file);
  const ConfigNode* table = root.find(kTable);
  if (table == nullptr || !table->is_table()) {
    throw ConfigError(Problem{.place = {.file = file},
                              .key = kTable,
                              .text = "is missing: the file needs a table [arm_deltas]"});
  }
  std::vector<Problem> errors;
  ArmDeltas deltas;
  KeyReader reader(table, kTable, errors);
  visit_keys(reader, deltas);
  reader.require(reader.is_given("model"), "model", "is missing: ur3, ur3e or ur5e");
  reader.report_unknown();
  throw_if_any(errors);
  return deltas;
}

ArmDeltas read_arm_deltas(const std::filesystem::path& path) {
  return parse_arm_deltas(read_file(path), path.string());
}

}  // namespace glint
