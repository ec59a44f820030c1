//! Frames and their ranges as they are reported. Names and their order are an interface: scripts read them as JSON.

use serde::{Serialize, Serializer};
use shutter_range::{Counters, ErrorSource, Polarity, Post, Range, RangeStatus, Sigmas};

use crate::ranging::frame_sequence::FrameRanges;

#[derive(Serialize)]
pub(crate) struct Document {
    pub(crate) frames: Vec<Frame>,
}

#[derive(Serialize)]
pub(crate) struct Frame {
    pub(crate) name: String,
    pub(crate) torn: bool,
    pub(crate) ranges: Vec<RangeReport>,
    /// Edge points that came in: the sum of those of the ranges, the stray and the dropped ones.
    pub(crate) edges: u32,
    /// Edge points that belong to no line.
    pub(crate) stray_edges: u32,
    pub(crate) dropped_edges: u32,
    pub(crate) dropped_lines: u32,
    /// The direction of down in the camera's axes, as used.
    pub(crate) gravity: [f64; 3],
    pub(crate) sigma_gravity_deg: f64,
    /// Sentences for a person.
    pub(crate) hints: Vec<String>,
}

#[derive(Serialize)]
pub(crate) struct RangeReport {
    pub(crate) bearing: f64,
    pub(crate) inverse_depth_per_m: f64,
    pub(crate) sigma_inverse_depth_per_m: f64,
    pub(crate) depth_m: Option<f64>,
    pub(crate) sigma_depth_m: Option<f64>,
    pub(crate) distance_m: Option<f64>,
    #[serde(skip)]
    pub(crate) sigma_distance_m: Option<f64>,
    /// The lower bound at two sigma.
    #[serde(skip)]
    pub(crate) nearest_distance_m: Option<f64>,
    pub(crate) nearest_m: Option<f64>,
    pub(crate) farthest_m: Option<f64>,
    pub(crate) first_row: u16,
    pub(crate) last_row: u16,
    pub(crate) column_at_first_row: f64,
    pub(crate) column_at_last_row: f64,
    pub(crate) edges: u16,
    pub(crate) polarity: Option<&'static str>,
    #[serde(serialize_with = "by_name")]
    pub(crate) status: RangeStatus,
    /// The same for an edge in all frames of a sequence; null for an edge that is not tracked from frame to frame.
    pub(crate) line_id: Option<u32>,
    /// Number of frames that the values were estimated from.
    pub(crate) frames: u32,
    pub(crate) tilt_deg: f64,
    pub(crate) sigma_tilt_deg: f64,
    /// The correlated part of the depth's relative sigma: that of errors that all edges of the frame share.
    pub(crate) sigma_common: Option<f64>,
    /// The source of most of sigma.
    pub(crate) dominant: &'static str,
    /// One sigma of inverse depth from each source.
    #[serde(skip)]
    pub(crate) budget: [(&'static str, f64); 8],
    /// How many of `edges` the values were estimated from: all but the outliers.
    pub(crate) edges_used: u16,
    /// Goodness of fit: residuals in units of their stated noise.
    pub(crate) misfit: f64,
    /// The index of the other side of the post that the edge is a side of; null where it is none.
    pub(crate) post: Option<usize>,
    /// To the middle of the post; null where its inverse depth is within three sigma of zero.
    pub(crate) post_distance_m: Option<f64>,
    pub(crate) post_sigma_m: Option<f64>,
}

impl Frame {
    pub(crate) fn new(name: String, torn: bool, found: &FrameRanges, counters: &Counters, hints: Vec<String>) -> Self {
        let [x, y, z] = found.gravity;
        Self {
            name,
            torn,
            ranges: found.ranges.iter().zip(&found.posts).map(|(range, post)| RangeReport::new(range, *post)).collect(),
            edges: counters.points,
            stray_edges: counters.stray_points.saturating_add(found.untold_points),
            dropped_edges: counters.dropped_points,
            dropped_lines: counters.dropped_lines,
            // No component is "-0".
            gravity: [x + 0.0, y + 0.0, z + 0.0],
            sigma_gravity_deg: found.sigma_gravity_rad.to_degrees(),
            hints: hints.into_iter().chain(found.hint.clone()).collect(),
        }
    }
}

impl RangeReport {
    fn new(range: &Range<f64>, post: Option<Post<f64>>) -> Self {
        const BOUNDS: Sigmas<f64> = Sigmas(2.0);
        let (estimate, depth, distance) = (&range.estimate, range.depth(BOUNDS), range.distance(BOUNDS));
        let middle = post.and_then(|post| post.distance(BOUNDS).estimate_m);
        Self {
            bearing: estimate.bearing,
            inverse_depth_per_m: estimate.inverse_depth_per_m,
            sigma_inverse_depth_per_m: estimate.sigma_inverse_depth_per_m,
            depth_m: depth.estimate_m.map(|(depth, _)| depth),
            sigma_depth_m: depth.estimate_m.map(|(_, sigma)| sigma),
            distance_m: distance.estimate_m.map(|(distance, _)| distance),
            sigma_distance_m: distance.estimate_m.map(|(_, sigma)| sigma),
            nearest_distance_m: distance.nearest_m,
            nearest_m: depth.nearest_m,
            farthest_m: depth.farthest_m,
            first_row: range.first_row,
            last_row: range.last_row,
            column_at_first_row: range.column_at_first_row,
            column_at_last_row: range.column_at_last_row,
            edges: range.points,
            polarity: polarity(range.polarity),
            status: range.status,
            line_id: range.line_id,
            frames: range.frames,
            tilt_deg: estimate.tilt.atan().to_degrees(),
            sigma_tilt_deg: estimate.sigma_tilt.to_degrees(),
            sigma_common: depth.estimate_m.map(|_| estimate.budget.correlated_per_m() / estimate.inverse_depth_per_m),
            dominant: source(estimate.budget.dominant()),
            budget: estimate.budget.parts().map(|(part, sigma_per_m)| (source(part), sigma_per_m)),
            edges_used: range.points_used,
            misfit: estimate.misfit,
            post: post.map(|post| post.other),
            post_distance_m: middle.map(|(distance, _)| distance),
            post_sigma_m: middle.map(|(_, sigma)| sigma),
        }
    }
}

fn by_name<S: Serializer>(status: &RangeStatus, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(status.name())
}

pub(crate) fn source(source: ErrorSource) -> &'static str {
    match source {
        ErrorSource::Noise => "noise",
        ErrorSource::Lean => "lean",
        ErrorSource::Gravity => "gravity",
        ErrorSource::Lens => "lens",
        ErrorSource::Speed => "speed",
        ErrorSource::Rate => "rate",
        ErrorSource::Readout => "readout",
        ErrorSource::Focal => "focal",
        _ => "other",
    }
}

pub(crate) fn polarity(polarity: Polarity) -> Option<&'static str> {
    match polarity {
        Polarity::Rising => Some("rising"),
        Polarity::Falling => Some("falling"),
        Polarity::Unknown => None,
    }
}
