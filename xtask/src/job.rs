//! [`Job`]: what a measuring program reads from its working directory; the other side is `firmware/src/job.rs`.

use shutter_range::EdgePoint;

/// The camera, what is known of it, and its motion, in SI units and pixels.
#[derive(Clone, Copy)]
pub(crate) struct Rig {
    pub(crate) columns: u16,
    pub(crate) rows: u16,
    pub(crate) readout_ns: i64,
    pub(crate) focal_px: f64,
    /// The principal point.
    pub(crate) centre_px: [f64; 2],
    /// As OpenCV orders them.
    pub(crate) distortion: [f64; 5],
    /// Of tilt, gravity, speed, rate, readout, time and focal length.
    pub(crate) sigmas: [f64; 7],
    pub(crate) exposure_s: f64,
    pub(crate) lens_px: f64,
}

impl Rig {
    /// QVGA, 300 px, 33.3 ms, 2 ms of exposure, 0.7 px of lens; edges may lean by 0.1°.
    pub(crate) const QVGA: Self = Self {
        columns: 320,
        rows: 240,
        readout_ns: 33_300_000,
        focal_px: 300.0,
        centre_px: [159.5, 119.5],
        distortion: [0.0; 5],
        sigmas: [0.001_745, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        exposure_s: 0.002,
        lens_px: 0.7,
    };

    pub(crate) fn row_time_s(&self, row: u16) -> f64 {
        f64::from(row) * self.readout_ns as f64 * 1e-9 / f64::from(self.rows)
    }
}

/// A motion in the axes of a frame's start.
#[derive(Clone, Copy)]
pub(crate) struct Motion {
    pub(crate) velocity_m_s: [f64; 3],
    pub(crate) rate_rad_s: [f64; 3],
    pub(crate) gravity: [f64; 3],
}

impl Motion {
    /// 1.5 m/s to the left, level.
    pub(crate) const SIDEWAYS: Self =
        Self { velocity_m_s: [-1.5, 0.0, 0.0], rate_rad_s: [0.0; 3], gravity: [0.0, 1.0, 0.0] };
}

/// Little-endian numbers.
#[derive(Default)]
pub(crate) struct Job(Vec<u8>);

impl Job {
    pub(crate) fn bytes(&self) -> &[u8] {
        &self.0
    }

    pub(crate) fn push(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
    }

    pub(crate) fn u16(&mut self, value: u16) {
        self.push(&value.to_le_bytes());
    }

    pub(crate) fn count(&mut self, items: usize) {
        self.u16(u16::try_from(items).expect("no job is that long"));
    }

    fn numbers<const N: usize>(&mut self, values: [f64; N]) {
        values.iter().for_each(|value| self.push(&((value * 1e9).round() as i64).to_le_bytes()));
    }

    pub(crate) fn rig(&mut self, rig: &Rig) {
        self.u16(rig.columns);
        self.u16(rig.rows);
        self.push(&rig.readout_ns.to_le_bytes());
        self.numbers([rig.focal_px]);
        self.numbers(rig.centre_px);
        self.numbers(rig.distortion);
        self.numbers(rig.sigmas);
        self.numbers([rig.exposure_s, rig.lens_px]);
    }

    pub(crate) fn motion(&mut self, motion: &Motion) {
        self.numbers(motion.velocity_m_s);
        self.numbers(motion.rate_rad_s);
        self.numbers(motion.gravity);
    }

    pub(crate) fn point(&mut self, point: &EdgePoint) {
        self.u16(point.row);
        self.u16(point.width_q8);
        self.push(&point.column_q16.to_le_bytes());
        self.push(&point.sigma_q16.to_le_bytes());
        self.u16(u16::from(point.polarity != shutter_range::Polarity::Rising));
        self.push(&point.time_ns.to_le_bytes());
    }

    /// The points of a line.
    pub(crate) fn line(&mut self, points: &[EdgePoint]) {
        self.count(points.len());
        points.iter().for_each(|point| self.point(point));
    }
}
