//! [`Sensor`]: a sensor on a bus.

use embedded_hal::i2c::{Error, ErrorKind, I2c};

use super::bus::Session;
use super::chip::Chip;
use super::description::{FrameSetting, ReadRegister};
use super::error::SensorError;
use super::mode::Mode;
use crate::error::ParameterError;

/// A sensor on an I²C bus that another driver has initialised.
///
/// It reads what is set, and sets nothing but exposure and frame length when asked to. It uses the bus only within its
/// methods: give it `&mut i2c`, or a handle of a shared bus, and initialise and stream with your own driver.
///
/// *Cost*: [`mode`](Self::mode) reads 14 to 39 bytes or words, each with its address: 1 to 4 ms at 400 kHz. Ask when
/// the mode has changed, not for each frame.
#[derive(Debug)]
pub struct Sensor<I2C> {
    i2c: I2C,
    chip: Chip,
    address: u8,
    clock_hz: u32,
}

impl<I2C: I2c> Sensor<I2C> {
    /// A chip of that kind, at any of its addresses, with the board's clock (XCLK, MCLK) in hertz.
    ///
    /// *Errors*: the bus's own; [`SensorError::WrongChip`] with what answers instead.
    pub fn new(mut i2c: I2C, chip: Chip, clock_hz: u32) -> Result<Self, SensorError<I2C::Error>> {
        let mut result = Err(SensorError::NotFound);
        for &address in chip.addresses() {
            result = identify(&mut i2c, chip, address);
            if !matches!(&result, Err(SensorError::Bus(error)) if is_absent(error)) {
                break;
            }
        }
        let address = result?;
        Ok(Self { i2c, chip, address, clock_hz })
    }

    /// Whichever of the known chips answers.
    ///
    /// It reads the identity of each at each of its addresses; to a chip that is none of them, but shares an address
    /// with one, it may write a page number. Where the chip is known, say so with [`new`](Self::new).
    ///
    /// *Errors*: the bus's own, unless it says that nobody answers; [`SensorError::NotFound`].
    pub fn find(mut i2c: I2C, clock_hz: u32) -> Result<Self, SensorError<I2C::Error>> {
        for chip in Chip::ALL {
            for &address in chip.addresses() {
                match identify(&mut i2c, chip, address) {
                    Ok(address) => return Ok(Self { i2c, chip, address, clock_hz }),
                    Err(SensorError::Bus(error)) if !is_absent(&error) => return Err(SensorError::Bus(error)),
                    Err(_) => {}
                }
            }
        }
        Err(SensorError::NotFound)
    }

    /// Which chip it is.
    #[must_use]
    pub const fn chip(&self) -> Chip {
        self.chip
    }

    /// Its address on the bus.
    #[must_use]
    pub const fn address(&self) -> u8 {
        self.address
    }

    /// Gives the bus back.
    #[must_use]
    pub fn release(self) -> I2C {
        self.i2c
    }

    /// What it does now.
    ///
    /// *Errors*: the bus's own; a register that holds what cannot be, with its value.
    pub fn mode(&mut self) -> Result<Mode, SensorError<I2C::Error>> {
        let (chip, clock_hz) = (self.chip, self.clock_hz);
        self.session(|session| chip.mode(session, clock_hz))
    }

    /// Sets the exposure in lines of the sensor ([`Mode::sensor_line_time_ps`]), and turns automatic exposure off.
    ///
    /// *Errors*: as [`mode`](Self::mode); an exposure of zero, or one that does not fit into the frame: lengthen that
    /// first.
    pub fn set_exposure_lines(&mut self, lines: u16) -> Result<(), SensorError<I2C::Error>> {
        let frame_lines = self.mode()?.frame_lines;
        let description = self.chip.description();
        let exposure = &description.exposure;
        let longest = frame_lines.saturating_sub(description.exposure_margin_lines);
        let longest = longest.min(exposure.register.max().checked_shr(exposure.shift).unwrap_or(0));
        if lines == 0 || u32::from(lines) > longest {
            let expected = "at least 1, and a little less than the frame";
            return Err(ParameterError::new("lines", lines.into(), expected).into());
        }
        self.session(|session| {
            let (automatic, by_hand) = description.manual_exposure;
            session.write(automatic, by_hand)?;
            session.write(exposure.register, u32::from(lines).checked_shl(exposure.shift).unwrap_or(0))?;
            description.commit.map_or(Ok(()), |(register, value)| session.write(register, value))
        })
    }

    /// Sets the length of a frame in lines of the sensor, blanking included. The line time stays.
    ///
    /// *Errors*: as [`mode`](Self::mode); a frame shorter than the rows that are read, or than the chip's shortest, or
    /// longer than its register holds.
    pub fn set_frame_lines(&mut self, lines: u32) -> Result<(), SensorError<I2C::Error>> {
        let mode = self.mode()?;
        let description = self.chip.description();
        self.session(|session| {
            let (register, read_anyway) = match description.frame {
                FrameSetting::Whole(register) => (register, 0),
                FrameSetting::Further(register) => (register, mode.frame_lines.saturating_sub(session.read(register)?)),
            };
            let value = lines.checked_sub(read_anyway).filter(|value| *value <= register.max());
            let Some(value) = value.filter(|_| lines > u32::from(mode.lines)) else {
                let expected = "above the rows that are read, and within the chip's registers";
                return Err(ParameterError::new("lines", lines.into(), expected).into());
            };
            session.write(register, value)?;
            description.commit.map_or(Ok(()), |(register, value)| session.write(register, value))
        })
    }

    /// Speaks with the chip and puts its page back, whatever came of it.
    fn session<T>(
        &mut self,
        speak: impl FnOnce(&mut Session<'_, I2C>) -> Result<T, SensorError<I2C::Error>>,
    ) -> Result<T, SensorError<I2C::Error>> {
        let mut session = Session::begin(&mut self.i2c, self.address, &self.chip.description().protocol);
        let result = speak(&mut session);
        let ended = session.end();
        let value = result?;
        ended.map(|()| value)
    }
}

/// The address, if the chip is there.
fn identify<I2C: I2c>(i2c: &mut I2C, chip: Chip, address: u8) -> Result<u8, SensorError<I2C::Error>> {
    let description = chip.description();
    let mut session = Session::begin(i2c, address, &description.protocol);
    let mut result = Ok(address);
    for &(register, expected) in description.identity {
        match session.read(register) {
            Ok(value) if value == expected => {}
            Ok(value) => result = Err(SensorError::WrongChip { register, value, expected }),
            Err(error) => result = Err(error),
        }
        if result.is_err() {
            break;
        }
    }
    let ended = session.end();
    let address = result?;
    ended.map(|()| address)
}

/// Nobody at that address.
fn is_absent<E: Error>(error: &E) -> bool {
    matches!(error.kind(), ErrorKind::NoAcknowledge(_))
}
