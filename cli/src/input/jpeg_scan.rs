//! Whether the scan of a baseline JPEG has all of its blocks. Decoders make up what a scan lacks, if an end marker
//! follows.

/// A table of codes in the order of their lengths.
#[derive(Clone, Default)]
struct Codes {
    counts: [u8; 16],
    values: Vec<u8>,
}

#[derive(Clone, Copy)]
struct Component {
    id: u8,
    /// Blocks of it in each unit of the scan.
    blocks: usize,
}

/// What the segments before the scan say.
#[derive(Default)]
pub(super) struct ScanHeader {
    /// Of differences and of the others, each by its number.
    codes: [[Codes; 4]; 2],
    components: Vec<Component>,
    units: usize,
    /// Units from one restart marker to the next; 0 for none.
    interval: usize,
}

impl ScanHeader {
    /// Takes a segment with its marker. `None` for one that is too short.
    pub(super) fn take(&mut self, marker: u8, segment: &[u8]) -> Option<()> {
        let length = usize::from(u16::from_be_bytes([*segment.get(2)?, *segment.get(3)?]));
        let content = segment.get(4..2 + length)?;
        match marker {
            0xC0 | 0xC1 => self.frame(content),
            0xC4 => self.tables(content),
            0xDD => {
                self.interval = usize::from(u16::from_be_bytes([*content.first()?, *content.get(1)?]));
                Some(())
            }
            _ => Some(()),
        }
    }

    fn frame(&mut self, content: &[u8]) -> Option<()> {
        let side = |at: usize| Some(usize::from(u16::from_be_bytes([*content.get(at)?, *content.get(at + 1)?])));
        let (rows, columns) = (side(1)?, side(3)?);
        let parts: Vec<(u8, usize, usize)> = content
            .get(6..)?
            .chunks_exact(3)
            .map(|part| (part[0], usize::from(part[1] >> 4), usize::from(part[1] & 15)))
            .collect();
        let most = |of: fn(&(u8, usize, usize)) -> usize| parts.iter().map(of).max().filter(|most| *most > 0);
        let (across, down) = (most(|part| part.1)?, most(|part| part.2)?);
        // A single component has one block in a unit, whatever its factors are.
        let is_single = parts.len() == 1;
        let (across, down) = if is_single { (1, 1) } else { (across, down) };
        self.units = columns.div_ceil(8 * across) * rows.div_ceil(8 * down);
        let component = |&(id, across, down): &(u8, usize, usize)| Component {
            id,
            blocks: if is_single { 1 } else { across * down },
        };
        self.components = parts.iter().map(component).collect();
        Some(())
    }

    fn tables(&mut self, mut content: &[u8]) -> Option<()> {
        while let Some((first, rest)) = content.split_first() {
            let counts: [u8; 16] = rest.get(..16)?.try_into().ok()?;
            let length: usize = counts.iter().map(|count| usize::from(*count)).sum();
            let values = rest.get(16..16 + length)?.to_vec();
            *self.codes.get_mut(usize::from(first >> 4))?.get_mut(usize::from(first & 15))? = Codes { counts, values };
            content = rest.get(16 + length..)?;
        }
        Some(())
    }

    /// Whether the scan, from its marker on, has all blocks and nothing else. `None` for one that is not baseline or
    /// has some of the components only.
    pub(super) fn is_whole(&self, scan: &[u8]) -> Option<bool> {
        let length = usize::from(u16::from_be_bytes([*scan.get(2)?, *scan.get(3)?]));
        let count = usize::from(*scan.get(4)?);
        if count != self.components.len() || count == 0 {
            return None;
        }
        let selectors: Vec<(u8, u8)> =
            scan.get(5..5 + 2 * count)?.chunks_exact(2).map(|pair| (pair[0], pair[1])).collect();
        let mut plan = Vec::new();
        for component in &self.components {
            let (_, tables) = selectors.iter().find(|(id, _)| *id == component.id)?;
            let [differences, others] = &self.codes;
            let codes = (differences.get(usize::from(tables >> 4))?, others.get(usize::from(tables & 15))?);
            plan.extend(std::iter::repeat_n(codes, component.blocks));
        }
        let mut bits = Bits { bytes: scan.get(2 + length..)?, byte: 0, left: 0 };
        Some(self.units_are_there(&plan, &mut bits).is_some())
    }

    fn units_are_there(&self, plan: &[(&Codes, &Codes)], bits: &mut Bits<'_>) -> Option<()> {
        for unit in 0..self.units {
            if self.interval > 0 && unit > 0 && unit % self.interval == 0 {
                bits.restart()?;
            }
            for (differences, others) in plan {
                bits.skip_block(differences, others)?;
            }
        }
        bits.at_end()
    }
}

/// The bits of a scan up to the next marker.
struct Bits<'a> {
    bytes: &'a [u8],
    byte: u8,
    left: u32,
}

impl Bits<'_> {
    fn bit(&mut self) -> Option<u8> {
        if self.left == 0 {
            let (byte, skipped) = match *self.bytes {
                [0xFF, 0, ..] => (0xFF, 2),
                [0xFF, ..] | [] => return None,
                [byte, ..] => (byte, 1),
            };
            self.byte = byte;
            self.left = 8;
            self.bytes = self.bytes.get(skipped..)?;
        }
        self.left -= 1;
        Some(self.byte >> self.left & 1)
    }

    fn skip(&mut self, count: u8) -> Option<()> {
        (0..count).try_for_each(|_| self.bit().map(|_| ()))
    }

    fn value(&mut self, codes: &Codes) -> Option<u8> {
        let (mut code, mut first, mut index) = (0_usize, 0_usize, 0_usize);
        for count in codes.counts {
            code = code << 1 | usize::from(self.bit()?);
            let count = usize::from(count);
            if code < first + count {
                return codes.values.get(index + code.checked_sub(first)?).copied();
            }
            index += count;
            first = (first + count) << 1;
        }
        None
    }

    fn skip_block(&mut self, differences: &Codes, others: &Codes) -> Option<()> {
        let size = self.value(differences)?;
        self.skip(size)?;
        let mut place = 1;
        while place < 64 {
            let value = self.value(others)?;
            let (run, size) = (value >> 4, value & 15);
            match (run, size) {
                (15, 0) => place += 16,
                (_, 0) => break,
                _ => {
                    self.skip(size)?;
                    place += usize::from(run) + 1;
                }
            }
        }
        (place <= 64).then_some(())
    }

    fn restart(&mut self) -> Option<()> {
        self.left = 0;
        let [0xFF, 0xD0..=0xD7, ..] = *self.bytes else { return None };
        self.bytes = self.bytes.get(2..)?;
        Some(())
    }

    /// The end marker, perhaps after fill bytes.
    fn at_end(&self) -> Option<()> {
        let mut rest = self.bytes;
        while let [0xFF, 0xFF, ..] = *rest {
            rest = rest.get(1..)?;
        }
        rest.starts_with(&[0xFF, 0xD9]).then_some(())
    }
}
