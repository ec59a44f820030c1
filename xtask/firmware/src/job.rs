//! The job: what the host has written to the file `job` for the board to do.

use crate::Number;
use semihosting::fs::File;
use semihosting::io::Read;
use shutter_range::{
    Camera, Distortion, EdgePoint, Intrinsics, MotionBlur, Polarity, Readout, ReadoutDirection, Response, Scalar,
    Setup, Twist, Uncertainty,
};

/// A reader of little-endian numbers.
pub struct Job(File);

impl Job {
    pub fn open() -> Self {
        Self(File::open(c"job").expect("a job in the working directory"))
    }

    pub fn bytes(&mut self, bytes: &mut [u8]) {
        self.0.read_exact(bytes).expect("a whole job");
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
    fn number(&mut self) -> Number {
        Number::from_ratio(self.i64(), 1_000_000_000)
    }

    fn numbers<const N: usize>(&mut self) -> [Number; N] {
        core::array::from_fn(|_| self.number())
    }

    pub fn setup(&mut self) -> Setup<Number> {
        let (columns, rows, readout_ns) = (self.u16(), self.u16(), self.i64());
        let focal = self.number();
        let distortion = Distortion::from_opencv(self.numbers());
        let camera = Camera::new(Intrinsics::centred(columns, rows, focal), distortion).expect("a sound camera");
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
    pub fn twist(&mut self) -> Twist<Number> {
        Twist::new(self.numbers(), self.numbers(), self.numbers()).expect("a sound motion")
    }

    pub fn point(&mut self) -> EdgePoint {
        let (row, width_q8) = (self.u16(), self.u16());
        let (column_q16, sigma_q16) = (self.i32(), self.i32() as u32);
        let polarity = if self.u16() == 0 { Polarity::Rising } else { Polarity::Falling };
        let point = EdgePoint::new(row, column_q16, self.i64());
        EdgePoint { width_q8, ..point.with_sigma_q16(sigma_q16).with_polarity(polarity) }
    }
}
