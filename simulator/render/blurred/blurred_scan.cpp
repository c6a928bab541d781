// SPDX-License-Identifier: GPL-3.0-or-later
//
// The sums over directions are made once for all frames (blurred_pixels.h): of a frame only the
// stripes' phase differs, so that a frame costs a few operations for each kept term, and no ray.
// docs/theory/blurred.md
#include "simulator/render/blurred/blurred_scan.h"

namespace glint {

ScanResult take_blurred_scan(const BlurredPixels& pixels,
                             const TunnelSettings& tunnel,
                             const Sensor& sensor,
                             const ScanSettings& scan,
                             const FrameConsumer& consume) {
  const double step_mm = scan_step_mm(scan, tunnel);
  ScanResult result;
  result.sums = ScanSums(pixels.even.width(), pixels.even.height());
  ImageF radiance;
  ImageF grey;
  for (int index = 0; index < scan.positions; ++index) {
    render_blurred(pixels, tunnel, index * step_mm, radiance);
    sensor.accumulate(radiance, index, result.sums, consume ? &grey : nullptr);
    if (consume) {
      consume(index, grey);
    }
  }
  result.aspect = result.sums.aspect();
  result.hidden_share = pixels.hidden_share;
  return result;
}

}  // namespace glint
