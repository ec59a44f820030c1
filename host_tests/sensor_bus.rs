//! A sensor of bytes on a bus: what is written is there, what is read is counted, and any step can fail.

use std::collections::BTreeMap;

use embedded_hal::i2c::{Error, ErrorKind, ErrorType, I2c, NoAcknowledgeSource, Operation};

/// How a chip is spoken to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wiring {
    pub(crate) wide_address: bool,
    pub(crate) wide_data: bool,
    pub(crate) repeated_start: bool,
    pub(crate) page_address: Option<u16>,
}

pub(crate) const SCCB: Wiring =
    Wiring { wide_address: false, wide_data: false, repeated_start: false, page_address: None };
pub(crate) const SCCB_WIDE: Wiring = Wiring { wide_address: true, ..SCCB };
pub(crate) const I2C_WIDE: Wiring = Wiring { repeated_start: true, ..SCCB_WIDE };
pub(crate) const I2C_WORDS: Wiring = Wiring { wide_data: true, ..I2C_WIDE };

pub(crate) const fn paged(page_address: u16) -> Wiring {
    Wiring { page_address: Some(page_address), ..SCCB }
}

/// A step on the bus, as a log.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Step {
    Write(Vec<u8>),
    Read(Vec<u8>),
    WriteRead(Vec<u8>, Vec<u8>),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Fault {
    Absent,
    /// Failed on purpose, at this step.
    Broken(usize),
    /// A repeated start where the chip has none, or a stop where it needs none.
    Protocol,
}

impl Error for Fault {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Absent => ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address),
            Self::Broken(_) => ErrorKind::Bus,
            Self::Protocol => ErrorKind::Other,
        }
    }
}

/// A chip at an address, with its registers by page and address.
#[derive(Clone, Debug)]
pub(crate) struct FakeSensor {
    pub(crate) at: u8,
    pub(crate) wiring: Wiring,
    pub(crate) registers: BTreeMap<(u16, u16), u16>,
    pub(crate) log: Vec<Step>,
    pub(crate) steps: usize,
    pub(crate) fails_at: Option<usize>,
    noise: Option<u64>,
    page: u16,
    pointer: u16,
}

impl FakeSensor {
    /// Registers of page 0; those of others are added by [`with_page`](Self::with_page).
    pub(crate) fn new(at: u8, wiring: Wiring, registers: &[(u16, u16)]) -> Self {
        let sensor = Self {
            at,
            wiring,
            registers: BTreeMap::new(),
            log: Vec::new(),
            steps: 0,
            fails_at: None,
            noise: None,
            page: 0,
            pointer: 0,
        };
        sensor.with_page(0, registers)
    }

    pub(crate) fn with_page(mut self, page: u16, registers: &[(u16, u16)]) -> Self {
        self.registers.extend(registers.iter().map(|&(address, value)| ((page, address), value)));
        self
    }

    pub(crate) fn at(self, at: u8) -> Self {
        Self { at, ..self }
    }

    /// With other values in page 0.
    pub(crate) fn with(self, registers: &[(u16, u16)]) -> Self {
        self.with_page(0, registers)
    }

    /// As another driver left it.
    pub(crate) fn on_page(mut self, page: u16) -> Self {
        self.page = page;
        self
    }

    pub(crate) fn page(&self) -> u16 {
        self.page
    }

    /// Registers that were never set hold what follows from a seed.
    pub(crate) fn with_noise(mut self, seed: u64) -> Self {
        self.noise = Some(seed);
        self
    }

    pub(crate) fn failing_at(mut self, step: usize) -> Self {
        self.fails_at = Some(step);
        self
    }

    pub(crate) fn value(&self, page: u16, address: u16) -> u16 {
        let noise = |seed: u64| {
            let mixed = (seed ^ u64::from(page) << 32 ^ u64::from(address)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            (mixed ^ mixed >> 29) as u16
        };
        let unset = self.noise.map_or(0, noise);
        self.registers.get(&(page, address)).copied().unwrap_or(unset)
    }

    fn point(&mut self, bytes: &[u8]) -> usize {
        match bytes {
            [high, low, ..] if self.wiring.wide_address => {
                self.pointer = u16::from_be_bytes([*high, *low]);
                2
            }
            [low, ..] if !self.wiring.wide_address => {
                self.pointer = (*low).into();
                1
            }
            _ => bytes.len(),
        }
    }

    fn set(&mut self, value: u16) {
        if self.wiring.page_address == Some(self.pointer) {
            self.page = value;
        } else {
            self.registers.insert((self.page, self.pointer), value);
        }
    }

    fn written(&mut self, bytes: &[u8]) {
        let used = self.point(bytes);
        match bytes[used..] {
            [] => {}
            [value] if !self.wiring.wide_data => self.set(value.into()),
            [high, low] if self.wiring.wide_data => self.set(u16::from_be_bytes([high, low])),
            _ => panic!("{bytes:x?} is no register"),
        }
    }

    fn fill(&self, bytes: &mut [u8]) {
        let value = if self.wiring.page_address == Some(self.pointer) {
            self.page
        } else {
            self.value(self.page, self.pointer)
        };
        match bytes {
            [byte] if !self.wiring.wide_data => *byte = value as u8,
            [high, low] if self.wiring.wide_data => [*high, *low] = value.to_be_bytes(),
            _ => panic!("{} bytes are no register", bytes.len()),
        }
    }
}

impl ErrorType for FakeSensor {
    type Error = Fault;
}

impl I2c for FakeSensor {
    fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), Fault> {
        let step = self.steps;
        self.steps += 1;
        if self.fails_at == Some(step) {
            return Err(Fault::Broken(step));
        }
        if address != self.at {
            return Err(Fault::Absent);
        }
        match operations {
            [Operation::Write(bytes)] => {
                self.written(bytes);
                self.log.push(Step::Write(bytes.to_vec()));
            }
            [Operation::Read(bytes)] if !self.wiring.repeated_start => {
                self.fill(bytes);
                self.log.push(Step::Read(bytes.to_vec()));
            }
            [Operation::Write(bytes), Operation::Read(answer)] if self.wiring.repeated_start => {
                self.written(bytes);
                self.fill(answer);
                self.log.push(Step::WriteRead(bytes.to_vec(), answer.to_vec()));
            }
            _ => return Err(Fault::Protocol),
        }
        Ok(())
    }
}
