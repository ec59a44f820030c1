//! [`Response`]: how grey levels follow the light.

/// How the grey levels of the pixels follow the light, the tone curve.
///
/// A blurred edge is symmetric in light. A curve that is not a straight line skews it, alike in all rows as long as the
/// contrast is; where that changes along the edge, the columns follow it. A known curve is undone where the pixels of
/// an edge are read, at one table look-up each.
///
/// A camera that sharpens or compresses has no response of this kind: leave it unknown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Response {
    /// Not known: no curve is undone, and the width of an edge is hardly trusted.
    #[default]
    Unknown,
    /// Grey levels are proportional to the light, as in raw frames.
    Linear,
    /// The curve of sRGB, which most processed frames have.
    Srgb,
    /// Any other curve: the light of each grey level, 0 to 65280 (255 × 256), rising.
    #[cfg_attr(feature = "serde", serde(skip))]
    Table(&'static [u16; 256]),
}

impl Response {
    /// The light of a grey level, both in 1/256 of a level.
    pub(crate) fn light_q8(&self, level_q8: u16) -> u16 {
        match self {
            Self::Unknown | Self::Linear => level_q8,
            Self::Srgb => look_up(&SRGB, level_q8),
            Self::Table(table) => look_up(table, level_q8),
        }
    }

    /// Whether there is no curve to undo.
    pub(crate) const fn is_identity(&self) -> bool {
        matches!(self, Self::Unknown | Self::Linear)
    }

    /// Whether the width of an edge follows from its blur alone.
    pub(crate) const fn is_linear(&self) -> bool {
        matches!(self, Self::Linear)
    }
}

/// Between whole levels the curve is straight.
fn look_up(table: &[u16; 256], level_q8: u16) -> u16 {
    let [level, part] = level_q8.to_be_bytes();
    // A level is always one of the 256.
    let at = |level: u8| u32::from(table.get(usize::from(level)).copied().unwrap_or(0));
    let (below, part) = (at(level), u32::from(part));
    if part == 0 {
        return below as u16;
    }
    ((below * (256 - part) + at(level.saturating_add(1)) * part) >> 8) as u16
}

/// The light of sRGB's grey levels (IEC 61966-2-1), times 65280.
#[rustfmt::skip]
const SRGB: [u16; 256] = [
    0, 20, 40, 59, 79, 99, 119, 139, 159, 178, 198, 218, 240, 263, 287, 312, 338, 366, 395, 425, 457, 490, 524, 559,
    596, 635, 674, 715, 758, 802, 848, 894, 943, 993, 1044, 1097, 1152, 1208, 1265, 1324, 1385, 1448, 1511, 1577,
    1644, 1713, 1784, 1856, 1929, 2005, 2082, 2161, 2242, 2324, 2408, 2494, 2582, 2671, 2762, 2855, 2950, 3046, 3145,
    3245, 3347, 3451, 3556, 3664, 3774, 3885, 3998, 4113, 4230, 4349, 4470, 4593, 4718, 4845, 4973, 5104, 5237, 5371,
    5508, 5647, 5787, 5930, 6075, 6222, 6371, 6521, 6674, 6829, 6986, 7146, 7307, 7470, 7636, 7803, 7973, 8145, 8319,
    8495, 8674, 8854, 9037, 9222, 9409, 9598, 9789, 9983, 10179, 10377, 10577, 10780, 10985, 11192, 11401, 11613,
    11826, 12043, 12261, 12482, 12705, 12930, 13158, 13388, 13620, 13854, 14091, 14331, 14572, 14816, 15063, 15311,
    15563, 15816, 16072, 16330, 16591, 16854, 17120, 17388, 17658, 17931, 18206, 18484, 18764, 19047, 19332, 19619,
    19910, 20202, 20497, 20795, 21095, 21397, 21702, 22010, 22320, 22633, 22948, 23266, 23586, 23909, 24234, 24562,
    24893, 25226, 25562, 25900, 26241, 26585, 26931, 27280, 27631, 27985, 28342, 28701, 29063, 29427, 29795, 30164,
    30537, 30912, 31290, 31671, 32054, 32440, 32828, 33220, 33614, 34011, 34410, 34812, 35217, 35625, 36035, 36448,
    36864, 37283, 37704, 38129, 38556, 38985, 39418, 39853, 40291, 40732, 41176, 41622, 42072, 42524, 42979, 43436,
    43897, 44361, 44827, 45296, 45768, 46243, 46720, 47201, 47684, 48171, 48660, 49152, 49647, 50145, 50646, 51149,
    51656, 52165, 52678, 53193, 53711, 54233, 54757, 55284, 55814, 56347, 56883, 57422, 57964, 58508, 59056, 59607,
    60161, 60718, 61277, 61840, 62406, 62975, 63547, 64121, 64699, 65280,

];
