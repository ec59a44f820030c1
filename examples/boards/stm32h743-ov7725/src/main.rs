//! OV7725 on an STM32H743 (Nucleo-144): frames by DCMI and DMA, a distance for each post, with the robot's own motion.
//!
//! | STM32H743 | | |
//! | --- | --- | --- |
//! | PB8, PB9 | OV7725 SCL, SDA | I2C1, pull-ups of 4.7 kΩ |
//! | PA8 | OV7725 XCLK | 16 MHz from here |
//! | PC6, PC7, PC8, PC9, PE4, PD3, PE5, PE6 | OV7725 D0 to D7 | |
//! | PA6, PA4, PB7 | OV7725 PCLK, HREF, VSYNC | |
//! | PE9, PE11 | wheel encoder A, B | TIM1 |
//! | PB10, PB11 | MPU-6050 SCL, SDA | I2C2; its axes are the robot's |
//!
//! The camera looks to the robot's left. *Expect* the chip and its line time, then for each frame, 8 a second or so, a
//! line for each edge: status, distance and sigma. Without wheels that turn, every edge is `Slow`.
#![no_std]
#![no_main]

mod odometry;
mod ov7725;

use defmt_rtt as _;
use embassy_executor::Spawner;
use embassy_stm32::dcmi::{self, Dcmi};
use embassy_stm32::i2c::I2c;
use embassy_stm32::rcc::{Mco, Mco1Source, McoConfig, McoPrescaler};
use embassy_stm32::{bind_interrupts, dma, peripherals};
use embassy_time::Instant;
use panic_probe as _;
use static_cell::{ConstStaticCell, StaticCell};

use odometry::Odometry;
use shutter_range::format::Strided;
use shutter_range::sensor::{Sensor, SensorError};
use shutter_range::{
    BoardRanger, Camera, Distortion, Intrinsics, Motion, Response, Setup, Sigmas, Trajectory, Uncertainty,
};

bind_interrupts!(struct Irqs {
    DCMI => dcmi::InterruptHandler<peripherals::DCMI>;
    DMA1_STREAM7 => dma::InterruptHandler<peripherals::DMA1_CH7>;
});

const XCLK_HZ: u32 = 16_000_000;
const COLUMNS: usize = 320;
const ROWS: usize = 240;
/// YUYV.
const ROW_BYTES: usize = 2 * COLUMNS;
/// Of the lens: focal length over the pitch of the pixels that are read, 2.8 mm / 12 µm here. Calibrate it.
const FOCAL_PX: f32 = 233.0;

static FRAME: StaticCell<[u32; ROW_BYTES * ROWS / 4]> = StaticCell::new();
static RANGER: ConstStaticCell<BoardRanger> = ConstStaticCell::new(BoardRanger::new());

type BusError = embassy_stm32::i2c::Error;
type Bus = I2c<'static, embassy_stm32::mode::Blocking, embassy_stm32::i2c::Master>;

/// What the sensor itself says of its timing, with what is known of the lens.
fn setup(sensor: &mut Sensor<&mut Bus>) -> Result<Setup<f32>, SensorError<BusError>> {
    let mode = sensor.mode()?;
    defmt::info!(
        "{} x {} pixels, {} ps a line, {} ppm",
        mode.columns,
        mode.rows(),
        mode.readout.line_time_ps(),
        mode.sigma_ppm
    );
    let camera = Camera::new(Intrinsics::centred(mode.columns, mode.rows(), FOCAL_PX), Distortion::NONE)?;
    let uncertainty = Uncertainty::default().with_sigma_readout(mode.sigma());
    Ok(Setup::new(camera, mode.readout)?.with_uncertainty(uncertainty)?.with_response(Response::Unknown))
}

/// Finds the edges of a frame's luma, row by row in the buffer that the DMA has filled.
fn find_edges(setup: &Setup<f32>, ranger: &mut BoardRanger, frame: &[u32]) {
    for (rows_read, bytes) in (0..).zip(bytemuck::cast_slice(frame).chunks_exact(ROW_BYTES)) {
        let row = setup.readout().row_after(rows_read);
        if let Err(refused) = ranger.row(setup, row, Strided::luma_first(bytes)) {
            defmt::warn!("{}", refused);
            break;
        }
    }
    ranger.end_frame(setup);
}

fn report<M: Motion<f32>>(setup: &Setup<f32>, motion: &M, ranger: &mut BoardRanger) {
    while let Some(range) = ranger.next_range(setup, motion) {
        defmt::info!("column {}: {}, {}", range.column_at_first_row, range.status, range.depth(Sigmas(2.0)));
    }
}

/// Nanoseconds since the start of the program, the clock of frames and of samples.
fn now_ns() -> i64 {
    Instant::now().as_micros() as i64 * 1000
}

async fn run(p: embassy_stm32::Peripherals, spawner: Spawner) -> Result<(), SensorError<BusError>> {
    let mut config = McoConfig::default();
    config.prescaler = McoPrescaler::DIV4; // of 64 MHz
    let _xclk = Mco::new(p.MCO1, p.PA8, Mco1Source::HSI, config);
    let mut bus = I2c::new_blocking(p.I2C1, p.PB8, p.PB9, Default::default());
    ov7725::initialise(&mut bus).await?;
    let mut sensor = Sensor::find(&mut bus, XCLK_HZ)?;
    defmt::info!("{}", sensor.chip());
    let setup = setup(&mut sensor)?;
    let readout_ns = setup.readout().row_time_ns(ROWS as u16 - 1);

    let odometry = Odometry::new(p.TIM1, p.PE9, p.PE11, I2c::new_blocking(p.I2C2, p.PB10, p.PB11, Default::default()));
    match odometry::sample(odometry) {
        Ok(task) => spawner.spawn(task),
        Err(_) => defmt::warn!("no odometry"),
    }
    let mut trajectory = Trajectory::<f32, 32>::new(odometry::CLOCKS);
    let mut camera = Dcmi::new_8bit(
        p.DCMI,
        p.DMA1_CH7,
        Irqs,
        p.PC6,
        p.PC7,
        p.PC8,
        p.PC9,
        p.PE4,
        p.PD3,
        p.PE5,
        p.PE6,
        p.PB7,
        p.PA4,
        p.PA6,
        dcmi::Config::default(),
    );
    let (frame, ranger) = (FRAME.init_with(|| [0; ROW_BYTES * ROWS / 4]), RANGER.take());
    loop {
        if let Err(error) = camera.capture(frame).await {
            defmt::warn!("capture: {}", error);
            continue;
        }
        let end_ns = now_ns();
        odometry::take_samples(&mut trajectory);
        // The sensor's automatic exposure is another one for each frame.
        let exposure_s = sensor.mode()?.exposure_s();
        let setup = setup.with_exposure_s(exposure_s)?;
        find_edges(&setup, ranger, frame);
        // The last row has just been read; its exposure ended with that.
        let start_ns = end_ns - readout_ns - (exposure_s * 0.5e9) as i64;
        match trajectory.frame(start_ns, 0..=readout_ns) {
            Ok(motion) => report(&setup, &motion, ranger),
            Err(gap) => {
                defmt::warn!("{}", gap);
                while ranger.next_line().is_some() {}
            }
        }
        defmt::info!("frame, {}", ranger.counters());
    }
}

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    if let Err(error) = run(embassy_stm32::init(Default::default()), spawner).await {
        defmt::error!("{}", error);
    }
}
