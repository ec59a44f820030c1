//! [`Session`]: registers over a bus, with the page kept in order.

use embedded_hal::i2c::I2c;

use super::description::{Protocol, ReadRegister};
use super::error::SensorError;
use super::register::{Part, Register};

/// A chip that is being spoken to. Whoever begins one must [`end`](Self::end) it: other drivers rely on the page that
/// they selected.
pub(super) struct Session<'a, I2C> {
    i2c: &'a mut I2C,
    address: u8,
    protocol: &'static Protocol,
    /// Page as it was found, and as it is now.
    pages: Option<(u32, u32)>,
}

impl<'a, I2C: I2c> Session<'a, I2C> {
    pub(super) fn begin(i2c: &'a mut I2C, address: u8, protocol: &'static Protocol) -> Self {
        Self { i2c, address, protocol, pages: None }
    }

    /// Selects the page that was found, if it is another one now.
    pub(super) fn end(mut self) -> Result<(), SensorError<I2C::Error>> {
        match self.pages {
            Some((found, now)) if found != now => self.select(found),
            _ => Ok(()),
        }
    }

    /// Writes a number into a register's bits and leaves the others as they are.
    pub(super) fn write(&mut self, register: &'static Register, value: u32) -> Result<(), SensorError<I2C::Error>> {
        self.turn_to(register)?;
        let mut bits: u32 = register.parts.iter().map(Part::bits).sum();
        for part in register.parts {
            bits = bits.saturating_sub(part.bits());
            let all = if self.protocol.wide_data { u16::MAX } else { 0xff };
            let before = if part.mask == all { 0 } else { self.read_part(part.address)? };
            let of_part = value.checked_shr(bits).unwrap_or(0);
            self.write_part(part.address, part.insert(before, of_part))?;
        }
        Ok(())
    }

    fn turn_to(&mut self, register: &'static Register) -> Result<(), SensorError<I2C::Error>> {
        let Some(page) = self.protocol.page else { return Ok(()) };
        let (found, now) = match self.pages {
            Some(pages) => pages,
            None => {
                let found = self.read_parts(page)?;
                (found, found)
            }
        };
        self.pages = Some((found, now));
        let wanted = u32::from(register.page);
        if now == wanted { Ok(()) } else { self.select(wanted) }
    }

    fn select(&mut self, page: u32) -> Result<(), SensorError<I2C::Error>> {
        let Some(register) = self.protocol.page else { return Ok(()) };
        for part in register.parts {
            // Never back what was read there besides: a bit that resets the chip, say.
            self.write_part(part.address, part.insert(0, page))?;
        }
        self.pages = self.pages.map(|(found, _)| (found, page));
        Ok(())
    }

    fn read_parts(&mut self, register: &'static Register) -> Result<u32, SensorError<I2C::Error>> {
        let mut value = 0_u32;
        for part in register.parts {
            let bits = part.extract(self.read_part(part.address)?);
            value = value.checked_shl(part.bits()).unwrap_or(0) | bits;
        }
        Ok(value)
    }

    fn read_part(&mut self, address: u16) -> Result<u16, SensorError<I2C::Error>> {
        let (wide, [_, low]) = (address.to_be_bytes(), address.to_be_bytes());
        let narrow = [low];
        let address: &[u8] = if self.protocol.wide_address { &wide } else { &narrow };
        if self.protocol.wide_data {
            let mut bytes = [0; 2];
            self.transfer(address, &mut bytes)?;
            Ok(u16::from_be_bytes(bytes))
        } else {
            let mut bytes = [0; 1];
            self.transfer(address, &mut bytes)?;
            let [byte] = bytes;
            Ok(byte.into())
        }
    }

    fn transfer(&mut self, address: &[u8], bytes: &mut [u8]) -> Result<(), SensorError<I2C::Error>> {
        if self.protocol.repeated_start {
            return self.i2c.write_read(self.address, address, bytes).map_err(SensorError::Bus);
        }
        self.i2c.write(self.address, address).map_err(SensorError::Bus)?;
        self.i2c.read(self.address, bytes).map_err(SensorError::Bus)
    }

    fn write_part(&mut self, address: u16, value: u16) -> Result<(), SensorError<I2C::Error>> {
        let ([high, low], [value_high, value_low]) = (address.to_be_bytes(), value.to_be_bytes());
        let result = match (self.protocol.wide_address, self.protocol.wide_data) {
            (true, true) => self.i2c.write(self.address, &[high, low, value_high, value_low]),
            (true, false) => self.i2c.write(self.address, &[high, low, value_low]),
            (false, _) => self.i2c.write(self.address, &[low, value_low]),
        };
        result.map_err(SensorError::Bus)
    }
}

impl<I2C: I2c> ReadRegister for Session<'_, I2C> {
    type BusError = I2C::Error;

    fn read(&mut self, register: &'static Register) -> Result<u32, SensorError<I2C::Error>> {
        self.turn_to(register)?;
        self.read_parts(register)
    }
}
