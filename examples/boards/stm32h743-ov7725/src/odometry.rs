//! The robot's motion as its wheels and its gyroscope tell it, in the camera's axes.

use embassy_stm32::Peri;
use embassy_stm32::i2c::{I2c, Master};
use embassy_stm32::mode::Blocking;
use embassy_stm32::peripherals::{PE9, PE11, TIM1};
use embassy_stm32::timer::qei::Qei;
use embassy_sync::blocking_mutex::raw::ThreadModeRawMutex;
use embassy_sync::channel::Channel;
use embassy_time::{Duration, Ticker};

use shutter_range::{SensorClock, StampConvention, Trajectory, TrajectoryConfig};

const PERIOD: Duration = Duration::from_millis(5);
const COUNTS_PER_M: f32 = 4_000.0;
const GYROSCOPE: u8 = 0x68;
const GYROSCOPE_POWER: u8 = 0x6B;
const GYROSCOPE_RATES: u8 = 0x43;
/// Counts of 1/131 of a degree per second, at the range of ±250 degrees per second that it has after reset.
const RAD_S_PER_COUNT: f32 = core::f32::consts::PI / 180.0 / 131.0;

const CLOCK: SensorClock = SensorClock { offset_ns: 0, max_gap_ns: 15_000_000 };
/// Wheel counts are a mean over their period, a rate is that of its instant.
pub(crate) const CLOCKS: TrajectoryConfig = TrajectoryConfig {
    velocity: StampConvention::MeanSincePrevious(CLOCK),
    rate: Some(StampConvention::Instant(CLOCK)),
    gravity: None,
};

struct Sample {
    time_ns: i64,
    speed_m_s: f32,
    /// Forward, left, up.
    rate_rad_s: [f32; 3],
}

static SAMPLES: Channel<ThreadModeRawMutex, Sample, 32> = Channel::new();

pub(crate) struct Odometry {
    wheel: Qei<'static, TIM1>,
    gyroscope: I2c<'static, Blocking, Master>,
}

impl Odometry {
    pub(crate) fn new(
        timer: Peri<'static, TIM1>,
        a: Peri<'static, PE9>,
        b: Peri<'static, PE11>,
        gyroscope: I2c<'static, Blocking, Master>,
    ) -> Self {
        Self { wheel: Qei::new(timer, a, b, Default::default()), gyroscope }
    }

    fn rate_rad_s(&mut self) -> Result<[f32; 3], embassy_stm32::i2c::Error> {
        let mut bytes = [0; 6];
        self.gyroscope.blocking_write_read(GYROSCOPE, &[GYROSCOPE_RATES], &mut bytes)?;
        let [x, y, z] = [[bytes[0], bytes[1]], [bytes[2], bytes[3]], [bytes[4], bytes[5]]];
        Ok([x, y, z].map(|pair| f32::from(i16::from_be_bytes(pair)) * RAD_S_PER_COUNT))
    }
}

/// Takes a sample each period. One for which there is no room is left out: the trajectory then tells the gap.
#[embassy_executor::task]
pub(crate) async fn sample(mut odometry: Odometry) {
    if odometry.gyroscope.blocking_write(GYROSCOPE, &[GYROSCOPE_POWER, 0]).is_err() {
        defmt::error!("no gyroscope");
        return;
    }
    let (mut ticker, mut last) = (Ticker::every(PERIOD), odometry.wheel.count());
    loop {
        ticker.next().await;
        let (time_ns, count) = (crate::now_ns(), odometry.wheel.count());
        let counts = count.wrapping_sub(last) as i16;
        last = count;
        let speed_m_s = f32::from(counts) / COUNTS_PER_M * 1e6 / PERIOD.as_micros() as f32;
        match odometry.rate_rad_s() {
            Ok(rate_rad_s) => drop(SAMPLES.try_send(Sample { time_ns, speed_m_s, rate_rad_s })),
            Err(error) => defmt::warn!("gyroscope: {}", error),
        }
    }
}

/// All samples that have come since, in the axes of a camera that looks to the left: right is forward, down is down.
pub(crate) fn take_samples<const N: usize>(trajectory: &mut Trajectory<f32, N>) {
    while let Ok(Sample { time_ns, speed_m_s, rate_rad_s: [forward, left, up] }) = SAMPLES.try_receive() {
        let pushed = trajectory
            .push_velocity(time_ns, [speed_m_s, 0.0, 0.0])
            .and_then(|()| trajectory.push_rate(time_ns, [forward, -up, left]));
        if let Err(error) = pushed {
            defmt::warn!("{}", error);
        }
    }
}
