//! The table of typical modes: computed, in the documentation as in the code, and of the very registers that a chip
//! reads.

use std::fmt::Write;

use shutter_range::sensor::{Chip, Kind, typical_modes};

/// The table as it stands in the documentation of `sensor`.
fn table() -> String {
    let mut text = String::from(
        "| sensor | mode | clock into it | image | line time per row | frame readout | known | by |\n\
         | --- | --- | --- | --- | --- | --- | --- | --- |\n",
    );
    for typical in typical_modes() {
        let mode = typical.mode().unwrap_or_else(|error| panic!("{}: {error}", typical.name));
        let row_us = mode.readout.line_time_ps() as f64 * 1e-6;
        let lines = f64::from(mode.lines) / f64::from(mode.rows());
        let of_lines = if mode.lines == mode.rows() { String::new() } else { format!(" ({lines:.2} lines)") };
        let _ = writeln!(
            text,
            "| {} | {} | {} MHz | {} × {} | {row_us:.2} µs{of_lines} | {:.1} ms | {} | {} |",
            typical.chip.name(),
            typical.name,
            typical.clock_hz / 1_000_000,
            mode.columns,
            mode.rows(),
            row_us * f64::from(mode.rows()) * 1e-3,
            typical.kind.name(),
            typical.source,
        );
    }
    text
}

#[test]
fn the_table_in_the_documentation_is_the_one_that_is_computed() {
    let table = table();
    assert!(include_str!("../src/sensor/modes.md") == table, "src/sensor/modes.md must be:\n{table}");
}

#[test]
fn every_chip_has_two_modes_in_the_table() {
    for chip in Chip::ALL {
        let modes = typical_modes().iter().filter(|mode| mode.chip == chip);
        assert!(modes.count() >= 2, "{}", chip.name());
    }
}

/// Frame rates that the sources state, by the names of the modes.
#[test]
fn computed_modes_have_the_frame_rates_that_their_sources_state() {
    let stated = [
        ("OV7670", "VGA YUV", 30.0),
        ("OV7670", "QVGA YUV, 12 MHz x 4", 30.0),
        ("OV7725", "VGA YUV", 30.0),
        ("OV7725", "VGA, OpenMV H7", 60.0),
        ("OV7725", "QVGA, OpenMV H7", 150.0),
        ("OV2640", "UXGA", 15.0 * 20.0 / 24.0),
        ("OV2640", "SVGA", 30.0 * 20.0 / 24.0),
        ("OV2640", "CIF JPEG, esp32-camera", 50.0),
        ("OV3660", "VGA RGB, esp32-camera", 4.44),
        ("OV5640", "5 MP", 15.0),
        ("OV5640", "1080p", 30.0),
        ("HM01B0", "QVGA", 59.94),
        ("GC2145", "UXGA", 20.0),
        ("GC2145", "720p", 30.0),
        ("MT9M114", "1280 x 960", 30.0),
    ];
    for (chip, name, rate_hz) in stated {
        let mut modes = typical_modes().iter();
        let typical = modes.find(|mode| mode.chip.name() == chip && mode.name == name);
        let typical = typical.unwrap_or_else(|| panic!("no {name} of {chip}"));
        assert!(typical.kind != Kind::Documented, "{chip}, {name}");
        let mode = typical.mode().expect("a sound table");
        let computed_hz = 1e9 / mode.frame_time_ns() as f64;
        assert!((computed_hz / rate_hz - 1.0).abs() < 0.001, "{chip}, {name}: {computed_hz}");
    }
}

#[test]
fn registers_have_a_name_a_meaning_and_a_place_of_their_own() {
    for chip in Chip::ALL {
        let registers: Vec<_> = chip.registers().collect();
        assert!(registers.len() > 10, "{}", chip.name());
        for (index, register) in registers.iter().enumerate() {
            assert!(!register.name.is_empty() && !register.meaning.is_empty());
            assert!(!register.parts.is_empty() && register.parts.iter().all(|part| part.mask != 0));
            let same = |other: &&shutter_range::sensor::Register| {
                other.name == register.name || (other.page, other.parts) == (register.page, register.parts)
            };
            assert!(!registers[..index].iter().any(same), "{}: {}", chip.name(), register.name);
        }
    }
}
