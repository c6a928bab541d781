// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/inspect_by_opencv.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace glint {
namespace {

cv::Mat copy_of(const Mask& mask) {
  cv::Mat copy(mask.height(), mask.width(), CV_8U);
  for (int y = 0; y < mask.height(); ++y) {
    std::transform(mask.row(y), mask.row(y) + mask.width(), copy.ptr(y), [](unsigned char value) {
      return static_cast<unsigned char>(value != 0 ? 255 : 0);
    });
  }
  return copy;
}

double middle_of(std::vector<float>& values) {
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), nth, values.end());
  return static_cast<double>(*nth);
}

}  // namespace

/// Pictures are kept from call to call, as OpenCV's users do.
struct OpenCvInspector::Data {
  int kernel_px = 0;
  double sigma_px = 0.0;
  cv::Mat outside;
  cv::Mat region;
  cv::Mat elsewhere;
  cv::Mat inverse_share;
  cv::Mat sum;
  cv::Mat aspect;
  cv::Mat smooth;
  cv::Mat response;
  cv::Mat beyond;
  cv::Mat labels;
  cv::Mat stats;
  cv::Mat centers;

  void blur(const cv::Mat& from, cv::Mat& to) const {
    cv::GaussianBlur(from, to, {kernel_px, kernel_px}, sigma_px, sigma_px, cv::BORDER_CONSTANT);
  }

  double robust_deviation() const {
    std::vector<float> values;
    for (int y = 0; y < response.rows; ++y) {
      for (int x = 0; x < response.cols; ++x) {
        if (region.at<unsigned char>(y, x) != 0) {
          values.push_back(response.at<float>(y, x));
        }
      }
    }
    const double middle = middle_of(values);
    for (float& value : values) {
      value = std::abs(value - static_cast<float>(middle));
    }
    return 1.4826 * middle_of(values);
  }

  OpenCvBlob blob(int label) const {
    const cv::Rect box(stats.at<int>(label, cv::CC_STAT_LEFT),
                       stats.at<int>(label, cv::CC_STAT_TOP),
                       stats.at<int>(label, cv::CC_STAT_WIDTH),
                       stats.at<int>(label, cv::CC_STAT_HEIGHT));
    const cv::Mat is_own = labels(box) == label;
    const cv::Moments moments = cv::moments(is_own, true);
    return {.x_px = centers.at<double>(label, 0) + 0.5,
            .y_px = centers.at<double>(label, 1) + 0.5,
            .area_px = stats.at<int>(label, cv::CC_STAT_AREA),
            .weight = cv::mean(response(box), is_own)[0] * moments.m00,
            .mu20 = moments.mu20 / moments.m00,
            .mu11 = moments.mu11 / moments.m00,
            .mu02 = moments.mu02 / moments.m00};
  }
};

OpenCvInspector::OpenCvInspector(
    int kernel_px, double sigma_px, const Mask& mask, const Mask& region, int threads)
    : data_(std::make_unique<Data>()) {
  cv::setNumThreads(threads);
  data_->kernel_px = kernel_px;
  data_->sigma_px = sigma_px;
  const cv::Mat inside = copy_of(mask);
  data_->outside = inside == 0;
  data_->region = copy_of(region);
  data_->elsewhere = data_->region == 0;
  cv::Mat ones;
  inside.convertTo(ones, CV_32F, 1.0 / 255.0);
  cv::Mat share;
  data_->blur(ones, share);
  data_->inverse_share = 1.0 / cv::max(share, 1e-6);
}

OpenCvInspector::~OpenCvInspector() = default;

std::vector<OpenCvBlob> OpenCvInspector::inspect(const std::vector<Image<std::uint8_t>>& frames,
                                                 std::optional<double> threshold) {
  Data& data = *data_;
  data.sum.create(frames[0].height(), frames[0].width(), CV_32F);
  data.sum.setTo(0.0);
  for (const Image<std::uint8_t>& frame : frames) {
    const cv::Mat picture(
        frame.height(), frame.width(), CV_8U, const_cast<std::uint8_t*>(frame.row(0)));
    cv::accumulate(picture, data.sum);
  }
  data.sum.convertTo(data.aspect, CV_32F, 1.0 / (255.0 * static_cast<double>(frames.size())));
  data.aspect.setTo(0.0, data.outside);
  data.blur(data.aspect, data.smooth);
  cv::multiply(data.smooth, data.inverse_share, data.smooth);
  cv::subtract(data.aspect, data.smooth, data.response);
  data.response.setTo(0.0, data.elsewhere);
  const double minimum = threshold.has_value() ? *threshold : 6.0 * data.robust_deviation();
  cv::compare(data.response, minimum, data.beyond, cv::CMP_GE);
  const int count =
      cv::connectedComponentsWithStats(data.beyond, data.labels, data.stats, data.centers, 8);
  std::vector<OpenCvBlob> blobs;
  for (int label = 1; label < count; ++label) {
    if (data.stats.at<int>(label, cv::CC_STAT_AREA) >= 2) {
      blobs.push_back(data.blob(label));
    }
  }
  return blobs;
}

}  // namespace glint
