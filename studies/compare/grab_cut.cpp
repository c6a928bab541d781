// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/grab_cut.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <opencv2/imgproc.hpp>

namespace glint {
namespace {

constexpr int kIterations = 4;

cv::Mat codes_of(const ImageF& picture) {
  const float largest = *std::ranges::max_element(picture.values());
  cv::Mat codes(picture.height(), picture.width(), CV_8UC3);
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const float share = largest > 0.0F ? picture(x, y) / largest : 0.0F;
      const auto code =
          static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(share, 0.0F, 1.0F)));
      codes.at<cv::Vec3b>(y, x) = cv::Vec3b(code, code, code);
    }
  }
  return codes;
}

/// Probable inside and outside in a band around the rough outline, sure beyond it.
cv::Mat labels_of(const Mask& rough) {
  cv::Mat inside(rough.height(), rough.width(), CV_8UC1);
  for (int y = 0; y < rough.height(); ++y) {
    std::copy_n(rough.row(y), rough.width(), inside.ptr<std::uint8_t>(y));
  }
  const double area = cv::countNonZero(inside);
  const int reach = std::max(3, static_cast<int>(0.1 * std::sqrt(area)));
  const cv::Mat disc =
      cv::getStructuringElement(cv::MORPH_ELLIPSE, cv::Size(2 * reach + 1, 2 * reach + 1));
  cv::Mat grown;
  cv::Mat shrunk;
  cv::dilate(inside, grown, disc);
  cv::erode(inside, shrunk, disc);
  cv::Mat labels(inside.size(), CV_8UC1, cv::Scalar(cv::GC_BGD));
  labels.setTo(cv::GC_PR_BGD, grown);
  labels.setTo(cv::GC_PR_FGD, inside);
  labels.setTo(cv::GC_FGD, shrunk);
  return labels;
}

}  // namespace

std::optional<Mask> grab_cut(const ImageF& picture, const Mask& rough) {
  cv::Mat labels = labels_of(rough);
  const int outside = cv::countNonZero(labels == cv::GC_BGD);
  if (outside == 0 || cv::countNonZero((labels == cv::GC_FGD) | (labels == cv::GC_PR_FGD)) == 0) {
    return std::nullopt;
  }
  cv::setRNGSeed(1);
  cv::Mat behind;
  cv::Mat front;
  cv::grabCut(
      codes_of(picture), labels, cv::Rect(), behind, front, kIterations, cv::GC_INIT_WITH_MASK);
  Mask mask(rough.width(), rough.height());
  std::size_t count = 0;
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      const std::uint8_t label = labels.at<std::uint8_t>(y, x);
      mask(x, y) = label == cv::GC_FGD || label == cv::GC_PR_FGD ? 1 : 0;
      count += mask(x, y);
    }
  }
  return count > 0 && count < mask.size() ? std::optional(mask) : std::nullopt;
}

}  // namespace glint
