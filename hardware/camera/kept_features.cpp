// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/camera/kept_features.h"

#include <array>
#include <optional>

namespace glint::aravis {
namespace {

/// First those that change the size of pictures.
constexpr std::array<const char*, 18> kKept = {"BinningHorizontal",
                                               "BinningVertical",
                                               "DecimationHorizontal",
                                               "DecimationVertical",
                                               "ReverseX",
                                               "ReverseY",
                                               "SensorShutterMode",
                                               "ExposureMode",
                                               "ConversionGain",
                                               "BlackLevelAuto",
                                               "BlackLevel",
                                               "BlackLevelRaw",
                                               "GammaEnable",
                                               "Gamma",
                                               "DigitalShift",
                                               "Sharpness",
                                               "LUTEnable",
                                               "TestPattern"};

/// None: the camera has no such feature now, or lets nobody change it.
std::optional<std::string> changeable_value(ArvDevice* device, const char* name) {
  ArvGcNode* const node = arv_device_get_feature(device, name);
  if (!ARV_IS_GC_FEATURE_NODE(node)) {
    return std::nullopt;
  }
  ArvGcFeatureNode* const feature = ARV_GC_FEATURE_NODE(node);
  if (arv_gc_feature_node_is_available(feature, nullptr) == FALSE ||
      arv_gc_feature_node_get_actual_access_mode(feature) != ARV_GC_ACCESS_MODE_RW) {
    return std::nullopt;
  }
  Failure failure;
  std::string value = text_of(arv_gc_feature_node_get_value_as_string(feature, failure.slot()));
  return failure || value.empty() ? std::nullopt : std::optional(std::move(value));
}

}  // namespace

// Not by arv_device_set_features_from_string(), which takes what follows a blank for the next
// assignment.
void set_feature(ArvDevice* device,
                 const std::string& name,
                 const std::string& value,
                 const std::string& key) {
  ArvGcNode* const node = arv_device_get_feature(device, name.c_str());
  if (!ARV_IS_GC_FEATURE_NODE(node)) {
    throw ConfigError(key, "this camera has no such feature");
  }
  Failure failure;
  if (ARV_IS_GC_COMMAND(node)) {
    arv_device_execute_command(device, name.c_str(), failure.slot());
  } else {
    arv_gc_feature_node_set_value_from_string(
        ARV_GC_FEATURE_NODE(node), value.c_str(), failure.slot());
  }
  failure.check(key);
}

NamedFeatures kept_features(ArvDevice* device) {
  NamedFeatures kept;
  for (const char* const name : kKept) {
    if (auto value = changeable_value(device, name)) {
      kept.emplace_back(name, *std::move(value));
    }
  }
  return kept;
}

void restore_features(ArvDevice* device, const NamedFeatures& features) {
  for (const auto& [name, value] : features) {
    if (changeable_value(device, name.c_str()) == value) {
      continue;
    }
    set_feature(device, name, value, name);
  }
}

}  // namespace glint::aravis
