//! [`Job`]: what the host has written for a board to do; the other side is `xtask/src/job.rs`.

use shutter_range::{
    Camera, Distortion, EdgePoint, Intrinsics, Line, MotionBlur, Polarity, Readout, ReadoutDirection, Response, Scalar,
    Setup, Twist, Uncertainty,
};

/// Where a job comes from: the file on a board, memory on the host.
pub trait Source {
    /// Fills all of the bytes.
    fn fill(&mut self, bytes: &mut [u8]);
}

impl Source for &[u8] {
    fn fill(&mut self, bytes: &mut [u8]) {
        let (next, rest) = self.split_at(bytes.len());
        bytes.copy_from_slice(next);
        *self = rest;
    }
}

/// A reader of little-endian numbers.
pub struct Job<R>(pub R);

impl<R: Source> Job<R> {
    pub fn bytes(&mut self, bytes: &mut [u8]) {
        self.0.fill(bytes);
    }

    fn array<const N: usize>(&mut self) -> [u8; N] {
        let mut bytes = [0; N];
        self.bytes(&mut bytes);
        bytes
    }

    pub fn u16(&mut self) -> u16 {
        u16::from_le_bytes(self.array())
    }

    fn i32(&mut self) -> i32 {
        i32::from_le_bytes(self.array())
    }

    fn i64(&mut self) -> i64 {
        i64::from_le_bytes(self.array())
    }

    /// A number, in 10⁻⁹.
    fn number<S: Scalar>(&mut self) -> S {
        S::from_ratio(self.i64(), 1_000_000_000)
    }

    fn numbers<S: Scalar, const N: usize>(&mut self) -> [S; N] {
        core::array::from_fn(|_| self.number())
    }

    pub fn setup<S: Scalar>(&mut self) -> Setup<S> {
        let (columns, rows, readout_ns) = (self.u16(), self.u16(), self.i64());
        let [focal, cx, cy] = self.numbers();
        let distortion = Distortion::from_opencv(self.numbers());
        let camera = Camera::new(Intrinsics { columns, rows, fx: focal, fy: focal, cx, cy }, distortion)
            .expect("a sound camera");
        let direction = ReadoutDirection::TopToBottom;
        let readout = Readout::from_frame_readout_ns(rows, readout_ns as u64, direction).expect("a sound readout");
        let [tilt, gravity, speed, rate, readout_part, time_s, focal] = self.numbers();
        let uncertainty = Uncertainty::NONE
            .with_sigma_tilt(tilt)
            .with_sigma_gravity(gravity)
            .with_sigma_speed(speed)
            .with_sigma_rate_rad_s(rate)
            .with_sigma_readout(readout_part)
            .with_sigma_time_s(time_s)
            .with_sigma_focal(focal);
        let [exposure_s, lens_px] = self.numbers();
        Setup::new(camera, readout)
            .and_then(|setup| setup.with_uncertainty(uncertainty))
            .and_then(|setup| {
                let setup = setup.with_response(Response::Linear);
                setup.with_motion_blur(MotionBlur::from_calibrated_lens(exposure_s, lens_px))
            })
            .expect("a sound setup")
    }

    /// Velocity, rate and gravity.
    pub fn twist<S: Scalar>(&mut self) -> Twist<S> {
        Twist::new(self.numbers(), self.numbers(), self.numbers()).expect("a sound motion")
    }

    pub fn point(&mut self) -> EdgePoint {
        let (row, width_q8) = (self.u16(), self.u16());
        let (column_q16, sigma_q16) = (self.i32(), self.i32() as u32);
        let polarity = if self.u16() == 0 { Polarity::Rising } else { Polarity::Falling };
        let point = EdgePoint::new(row, column_q16, self.i64());
        EdgePoint { width_q8, ..point.with_sigma_q16(sigma_q16).with_polarity(polarity) }
    }

    /// The points of a line.
    pub fn line(&mut self) -> Line<16> {
        let points = self.u16();
        let mut line = Line::new(self.point());
        for _ in 1..points {
            line.push(self.point()).expect("rows in order");
        }
        line
    }
}
