// SPDX-License-Identifier: GPL-3.0-or-later
//
// Aravis' C interface with owners and exceptions; included by the sources that use it alone.
#pragma once

#include <arv.h>

#include <memory>
#include <string>

#include <fmt/format.h>

#include "core/error.h"
#include "hardware/camera/camera_driver.h"

namespace glint::aravis {

struct Unref {
  void operator()(void* object) const { g_object_unref(object); }
};

template <class Object>
using Owner = std::unique_ptr<Object, Unref>;

struct Free {
  void operator()(void* memory) const { g_free(memory); }
};

/// Takes the error of one call: `Failure failure; arv_...(..., failure.slot());
/// failure.check("...")`
class Failure {
 public:
  Failure() = default;

  ~Failure() { g_clear_error(&error_); }

  Failure(const Failure&) = delete;
  Failure& operator=(const Failure&) = delete;

  GError** slot() { return &error_; }

  explicit operator bool() const { return error_ != nullptr; }

  std::string text() const { return error_ == nullptr ? "" : error_->message; }

  /// The camera has answered, with a refusal.
  bool is_refusal() const {
    return error_ != nullptr && error_->domain == ARV_DEVICE_ERROR &&
           (error_->code == ARV_DEVICE_ERROR_PROTOCOL_ERROR ||
            error_->code >= ARV_DEVICE_ERROR_PROTOCOL_ERROR_NOT_IMPLEMENTED);
  }

  /// @throws ConfigError for a value that the camera does not take, IoError for everything else
  void check(const std::string& doing) const {
    if (error_ == nullptr) {
      return;
    }
    if (error_->domain == ARV_GC_ERROR || is_refusal() ||
        (error_->domain == ARV_DEVICE_ERROR &&
         (error_->code == ARV_DEVICE_ERROR_FEATURE_NOT_FOUND ||
          error_->code == ARV_DEVICE_ERROR_WRONG_FEATURE))) {
      throw ConfigError(doing, error_->message);
    }
    throw IoError(fmt::format("camera: {}: {}", doing, error_->message));
  }

 private:
  GError* error_ = nullptr;
};

/// A text of Aravis', which may be none.
inline std::string text_of(const char* text) {
  return text == nullptr ? "" : text;
}

}  // namespace glint::aravis
