//! Samples of a trajectory of which several have one stamp: what their writer meant by it.

/// Velocity, rotation rate and perhaps gravity of one instant, in the axes of the camera there.
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct Sample {
    /// Since the start of the first frame.
    pub(crate) time_ns: i64,
    pub(crate) velocity_m_s: [f64; 3],
    pub(crate) rate_rad_s: [f64; 3],
    /// `None` where the file has no columns for it.
    pub(crate) gravity: Option<[f64; 3]>,
}

/// The same with stamps that rise. They do not fall in the samples given.
///
/// A sample that is there twice counts once. Where most stamps repeat even so, their clock is coarse: the samples of a
/// tick are spread evenly over it. Elsewhere different ones are a jump from the first of them to the last.
pub(crate) fn resolved(mut samples: Vec<Sample>) -> Vec<Sample> {
    samples.dedup();
    let ticks: Vec<&[Sample]> = samples.chunk_by(|a, b| a.time_ns == b.time_ns).collect();
    let repeated = ticks.iter().filter(|tick| tick.len() > 1).count();
    if repeated * 2 > ticks.len() && ticks.len() > 1 { spread(&ticks) } else { jumps(&ticks) }
}

/// The last tick is as long as the one before.
fn spread(ticks: &[&[Sample]]) -> Vec<Sample> {
    let starts: Vec<i64> = ticks.iter().filter_map(|tick| tick.first()).map(|sample| sample.time_ns).collect();
    let mut length_ns = 0;
    let mut found = Vec::new();
    for (index, tick) in ticks.iter().enumerate() {
        if let Some([start, next, ..]) = starts.get(index..) {
            length_ns = next - start;
        }
        let count = tick.len() as i64;
        found.extend((0..).zip(*tick).map(|(number, sample): (i64, &Sample)| Sample {
            time_ns: sample.time_ns + length_ns * number / count,
            ..*sample
        }));
    }
    found
}

fn jumps(ticks: &[&[Sample]]) -> Vec<Sample> {
    let mut found = Vec::new();
    for tick in ticks {
        let (Some(before), Some(after)) = (tick.first(), tick.last()) else { continue };
        found.push(*before);
        if after != before {
            found.push(Sample { time_ns: after.time_ns + 1, ..*after });
        }
    }
    found
}
