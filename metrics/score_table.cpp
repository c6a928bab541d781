// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/score_table.h"

#include <array>

namespace glint {
namespace {

constexpr std::array kDocs = {
    ScoreDoc{
        "homogeneity.h_rms",
        "1 - standard deviation / mean of the mean image over the flawless region; 1 is uniform, "
        "below 0 (no mistake) where the deviation is larger than the mean: mostly dark, a few "
        "spots "
        "bright"},
    ScoreDoc{"homogeneity.h_abs",
             "1 - mean absolute deviation / mean of the mean image over the flawless region; 1 is "
             "uniform, below 0 where the deviation is larger than the mean"},
    ScoreDoc{"homogeneity.robust",
             "1 - (P95 - P5) / (P95 + P5) of the mean image over the flawless region; a search "
             "takes percentiles only where its objective or a limit needs them"},
    ScoreDoc{"homogeneity.mean",
             "mean value of the flawless region in the mean image, share of full scale"},
    ScoreDoc{"homogeneity.clipped_share",
             "share of the flawless region at full scale in every frame, where nothing can show"},
    ScoreDoc{"homogeneity.lit_share", "share of the flawless region that light reaches"},
    ScoreDoc{"homogeneity.u0",
             "smallest 3 x 3 mean / mean of the mean image over the flawless region; 1 is uniform"},
    ScoreDoc{"homogeneity.residual",
             "1 - standard deviation / mean of the mean image / its shading, a Gaussian of "
             "metrics.shading_diameters; what software cannot remove; may be below 0, as h_rms"},
    ScoreDoc{"homogeneity.low_share",
             "share of the mean image's variance at wavelengths above four defect diameters, "
             "which software can remove"},
    ScoreDoc{"homogeneity.high_share",
             "share of the mean image's variance at wavelengths below four defect diameters, "
             "which raises false alarms"},
    ScoreDoc{"homogeneity.worst_region",
             "smallest h_rms of metrics.regions times as many tiles of the flawless region"},
    ScoreDoc{"homogeneity.ripple",
             "amplitude at the harmonics of the stripes, left in the mean image along the rows, "
             "/ mean; 0 is best"},
    ScoreDoc{"fringe.regularity",
             "coefficient of variation of the stripe spacing along the rows; 0 is regular"},
    ScoreDoc{"fringe.period_px", "mean stripe spacing along the rows in pixels"},
    ScoreDoc{"fringe.duty_error", "bright share of the stripes minus the nominal duty"},
    ScoreDoc{"fringe.modulation", "(max - min) / (max + min) of the stripes"},
    ScoreDoc{"defects.made", "how many defects the part has"},
    ScoreDoc{"defects.mean_depth_um", "mean depth of the defects, height of bumps"},
    ScoreDoc{"defects.removed_volume_mm3",
             "volume that imprinted and displaced defects remove; bumps count as negative"},
    ScoreDoc{"defects.min_cnr",
             "smallest contrast-to-noise ratio of any defect: "
             "|its mean - mean of its background| / standard deviation of the background"},
    ScoreDoc{"defects.min_weber",
             "smallest |Weber contrast| of any defect: "
             "|its mean - mean of its background| / mean of the background"},
    ScoreDoc{"defects.mean_weber", "mean |Weber contrast| of the defects"},
    ScoreDoc{"defects.min_dprime",
             "smallest detectability d' of any defect: "
             "norm of its deviation image / standard deviation of the background"},
    ScoreDoc{"defects.min_signature",
             "smallest signature of any defect: "
             "area that deviates visibly from the background / its true area"},
    ScoreDoc{"defects.min_change",
             "smallest change of any defect: "
             "largest mean |frame - the same frame of the flawless part|, share of full scale"},
    ScoreDoc{"defects.mean_change", "mean change of the defects"},
    ScoreDoc{"defects.min_rms_contrast",
             "smallest RMS contrast of any defect: "
             "standard deviation over it and its background / their mean"},
    ScoreDoc{"defects.min_best_frame",
             "smallest difference of any defect in its best frame: "
             "largest |its mean - mean of its background| of a single frame"},
    ScoreDoc{"defects.min_union",
             "smallest union of any defect: "
             "area that changes visibly against the flawless part in any frame / its true area"},
    ScoreDoc{
        "defects.<label>.cnr",
        "|mean of the defect - mean of its background| / standard deviation of the background"},
    ScoreDoc{"defects.<label>.weber",
             "(mean of the defect - mean of its background) / mean of the background"},
    ScoreDoc{"defects.<label>.peak",
             "Weber contrast of the defect's pixel that deviates most from the background"},
    ScoreDoc{"defects.<label>.michelson", "(max - min) / (max + min) within two defect radii"},
    ScoreDoc{"defects.<label>.dprime",
             "norm of the defect's deviation image / standard deviation of the background"},
    ScoreDoc{"defects.<label>.signature",
             "area that deviates visibly from the background / true area of the defect"},
    ScoreDoc{"defects.<label>.best_frame",
             "largest |mean of the defect - mean of its background| of any single frame"},
    ScoreDoc{"defects.<label>.change",
             "largest mean |frame - the same frame of the flawless part| over the defect, share of "
             "full scale; under stripes of full contrast the share of its area that flips"},
    ScoreDoc{"defects.<label>.rms_contrast",
             "standard deviation over the defect and its background together / their mean"},
    ScoreDoc{"defects.<label>.union",
             "area of the defect that changes visibly against the flawless part in any frame / "
             "true area of the defect"},
    ScoreDoc{"view.hidden_share",
             "share of the part's pixels that the wall occludes from the camera; those that it "
             "hides in part count in part"},
    ScoreDoc{"view.slot_margin_mm",
             "smallest distance of a sight line to the flawless region from the edge of the camera "
             "slot, across the tunnel; negative: the wall occludes some of it"},
    ScoreDoc{"inspection.detection_rate", "share of the defects that the inspection finds"},
    ScoreDoc{"inspection.false_alarms", "blobs found on a flawless part, on average"},
    ScoreDoc{"inspection.threshold",
             "threshold of the response that the inspection took, share of full scale"},
    ScoreDoc{"inspection.region_share",
             "share of the part, without its rim, that is lit and uniform enough to be inspected"},
    ScoreDoc{"inspection.rendering_share",
             "share of the rendering's own noise in the variance of a flawless part's response; 0 "
             "without path tracing"},
    ScoreDoc{"inspection.rendering_error",
             "share of the rendering's own noise in the squared changes that the defects make; 0 "
             "without path tracing"},
    ScoreDoc{"inspection.auc",
             "probability that the largest |response| about a defect exceeds that of the same "
             "place on a flawless part (area under the ROC curve)"},
    ScoreDoc{"inspection.dprime",
             "matched-filter d' against the covariance of the flawless picture: median over a "
             "group's defects, of the group where it is smallest"},
    ScoreDoc{"inspection.pod_a90_um",
             "depth or height that is found nine times of ten, from defects of different size"},
    ScoreDoc{"inspection.signature",
             "mean of the segmented area of a defect / its true area; 0 for a missed one"},
    ScoreDoc{"inspection.smallest_height_um",
             "depth or height at which half of the defects are found, all made larger or smaller "
             "by one factor"},
    ScoreDoc{"inspection.smallest_slope_mrad",
             "slope of the defects at inspection.smallest_height_um: the angle to the flawless "
             "surface below which 99 % of their area lies"},
    ScoreDoc{"inspection.<group>.detection_rate",
             "share of the group's defects that the inspection finds"},
    ScoreDoc{"inspection.<group>.auc", "inspection.auc over the group's defects"},
    ScoreDoc{"inspection.<group>.dprime",
             "matched-filter d' against the covariance of the flawless picture: median over the "
             "group's defects"},
    ScoreDoc{"inspection.<group>.pod_a90_um", "inspection.pod_a90_um over the group's defects"},
    ScoreDoc{"inspection.<group>.signature", "inspection.signature over the group's defects"},
    ScoreDoc{"coverage.c1", "share of the part's surface that at least one of the views inspects"},
    ScoreDoc{"coverage.c2",
             "share of the part's surface that at least two views inspect, from directions "
             "coverage.separation_deg or more apart"},
    ScoreDoc{"coverage.redundancy", "how many views inspect a place of the surface, on average"},
    ScoreDoc{"coverage.largest_gap_mm2",
             "area of the largest connected piece of the surface that no view inspects"},
    ScoreDoc{"reach.share", "share of the views that the arm of [cell] file can take"},
    ScoreDoc{"reach.margin_mm",
             "smallest distance of arm, camera and lights on it to anything that stands, over the "
             "views that it can take and the paths between them; 0 when it can take none"},
    ScoreDoc{"lighting.width_mm",
             "across the tunnel (along y): the box about the luminous surfaces of all lights that "
             "shine"},
    ScoreDoc{"lighting.height_mm", "of the same box along z"},
    ScoreDoc{"lighting.length_mm", "along the tunnel (along x): of the same box"},
    ScoreDoc{"lighting.area_mm2", "area of the luminous surfaces of all lights that shine"},
    ScoreDoc{"lighting.leds", "single LEDs of the rings that shine; lights without any have 0"},
    ScoreDoc{"scan.frames", "pictures in a scan"},
    ScoreDoc{"scan.time_s",
             "of a scan: cost.exposure_ms for each picture, cost.move_ms between two of them"},
    ScoreDoc{"cost.total",
             "of the lighting: cost.per_mm2, cost.per_led and cost.per_frame times luminous area, "
             "LEDs and pictures, in the unit of money that [cost] is written in"},
    ScoreDoc{"overlap.iou",
             "intersection over union of the part's regions in the simulated and the real picture, "
             "mean over the pictures of [reference]; 1 is equal"},
    ScoreDoc{
        "overlap.mean_distance_px",
        "mean distance of the part's outlines in the simulated and the real picture; 0 is best"},
    ScoreDoc{"overlap.edge_distance_px",
             "mean distance of the edges inside the part, between bright and dark places, in the "
             "simulated and the real picture, looked for up to 8 px apart; 0 is best, an edge "
             "without a counterpart counts 8 px"},
    ScoreDoc{"appearance.ssim",
             "structural similarity of the simulated and the real picture over the part in either; "
             "1 is equal"},
    ScoreDoc{"appearance.rms",
             "root of the mean squared difference of the simulated and the real picture over the "
             "part in either, share of full scale; 0 is best"},
    ScoreDoc{"appearance.histogram_distance",
             "Wasserstein distance of the grey values of the part in the simulated and in the real "
             "picture, share of full scale; 0 is best"},
    ScoreDoc{"rays.followed_share", "share of the rays that hit the part again and were followed"},
    ScoreDoc{"rays.blocked_share", "share of the rays that were given up as dark"},
    ScoreDoc{"rays.max_cells",
             "cells per axis that pixels beyond the reach of defects are cut into at most; only "
             "where more of the usual 16 would take more than 0.9 GB"},
};

}  // namespace

std::span<const ScoreDoc> score_table() {
  return kDocs;
}

}  // namespace glint
