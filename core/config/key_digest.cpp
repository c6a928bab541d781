// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/key_digest.h"

#include <array>
#include <cstring>

namespace glint {
namespace {

template <class Value>
void append_bytes(std::string& bytes, const Value& value) {
  std::array<char, sizeof(Value)> raw;
  std::memcpy(raw.data(), &value, sizeof(Value));
  bytes.append(raw.data(), raw.size());
}

/// With its length, so that two texts cannot be taken for one.
void append_text(std::string& bytes, std::string_view value) {
  append_bytes(bytes, value.size());
  bytes += value;
}

}  // namespace

void KeyDigest::number(std::string_view, double& value, const Range&, std::string_view) {
  append_bytes(bytes_, value == 0.0 ? 0.0 : value);  // no difference between 0 and -0
}

void KeyDigest::integer(std::string_view, int& value, const Range&, std::string_view) {
  append_bytes(bytes_, value);
}

void KeyDigest::boolean(std::string_view, bool& value, std::string_view) {
  bytes_ += value ? '1' : '0';
}

void KeyDigest::text(std::string_view, std::string& value, std::string_view) {
  append_text(bytes_, value);
}

void KeyDigest::file(std::string_view, std::filesystem::path& value, std::string_view) {
  append_text(bytes_, value.string());
}

void KeyDigest::files(std::string_view,
                      std::vector<std::filesystem::path>& values,
                      std::string_view) {
  append_bytes(bytes_, values.size());
  for (const std::filesystem::path& value : values) {
    append_text(bytes_, value.string());
  }
}

void KeyDigest::numbers(
    std::string_view, std::vector<double>& values, Count, const Range&, std::string_view) {
  append_bytes(bytes_, values.size());
  for (const double value : values) {
    append_bytes(bytes_, value == 0.0 ? 0.0 : value);
  }
}

void KeyDigest::interval(std::string_view, Interval& value, const Range&, std::string_view) {
  append_bytes(bytes_, value.min == 0.0 ? 0.0 : value.min);
  append_bytes(bytes_, value.max == 0.0 ? 0.0 : value.max);
}

void KeyDigest::choice_index(std::string_view,
                             int& index,
                             std::span<const std::string_view>,
                             std::string_view) {
  append_bytes(bytes_, index);
}

void KeyDigest::table(std::string_view,
                      const std::function<void(KeyVisitor&)>& visit,
                      std::string_view) {
  visit(*this);
}

}  // namespace glint
