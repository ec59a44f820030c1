//! Every chip's transactions one by one, on `embedded-hal-mock`: addresses, stops and pages as they go over the wire.

use embedded_hal_mock::eh1::i2c::{Mock, Transaction};
use shutter_range::sensor::{Chip, Sensor};

use crate::sensor_bus::{FakeSensor, Wiring};
use crate::sensor_chips::{CASES, Case};

/// What happens to a register.
#[derive(Clone, Copy)]
enum Access {
    Read(u16),
    /// The page register is written.
    Page(u16, u16),
}

use Access::Page;

/// Reads of so many addresses, one after the other.
macro_rules! reads {
    ($($address:literal)+) => { &[$(Access::Read($address)),+] };
}

/// How a chip is asked who it is, and what it does.
fn identity(chip: Chip) -> &'static [&'static [Access]] {
    match chip {
        Chip::Ov7670 | Chip::Ov7725 => &[reads!(0x0a 0x1c 0x1d)],
        // As another driver left it: on the DSP's bank, and there again afterwards.
        Chip::Ov2640 => &[reads!(0xff), &[Page(0xff, 1)], reads!(0x0a 0x1c 0x1d), &[Page(0xff, 0)]],
        Chip::Ov3660 | Chip::Ov5640 => &[reads!(0x300a 0x300b)],
        Chip::Hm01b0 | Chip::Hm0360 => &[reads!(0x0000 0x0001)],
        Chip::Gc0308 => &[reads!(0xfe 0x00)],
        Chip::Gc2145 => &[reads!(0xfe 0xf0 0xf1)],
        Chip::Mt9m114 => &[reads!(0x0000)],
        other => panic!("{} is not here", other.name()),
    }
}

const OMNIVISION: &[Access] = reads!(
    0x3800 0x3801 0x3804 0x3805 0x3810 0x3811 0x3802 0x3803 0x3806 0x3807 0x3812 0x3813 0x3814 0x3815 0x3808 0x3809
    0x380a 0x380b 0x5001 0x380c 0x380d 0x380e 0x380f 0x3500 0x3501 0x3502 0x3503 0x3821 0x3820
);

fn mode(chip: Chip) -> &'static [&'static [Access]] {
    match chip {
        Chip::Ov7670 => &[reads!(
            0x12 0x11 0x6b 0x17 0x32 0x18 0x32 0x19 0x03 0x1a 0x03 0x0c 0x3e 0x2a 0x2b 0x2e 0x2d 0x93 0x92 0x07 0x10 0x04
            0x13 0x1e 0x1e
        )],
        Chip::Ov7725 => &[reads!(
            0x12 0x12 0x11 0x0d 0x18 0x32 0x1a 0x32 0x2a 0x2b 0x2e 0x2d 0x34 0x33 0x08 0x10 0x13 0x0c 0x0c 0x29 0x2a 0x2c
            0x2a 0x17 0x32 0x19 0x32
        )],
        Chip::Ov2640 => &[
            reads!(0xff),
            &[Page(0xff, 1)],
            reads!(0x12 0x11 0x2a 0x2b 0x2e 0x2d 0x47 0x46 0x45 0x10 0x04 0x13 0x04 0x04),
            &[Page(0xff, 0)],
            reads!(0x05 0x57 0x55 0x51 0x55 0x52 0x55 0x53 0x55 0x54 0x5c 0x5a 0x5c 0x5b),
        ],
        Chip::Ov3660 => &[reads!(0x303a 0x303d 0x303d 0x303d 0x303b 0x303c), OMNIVISION],
        Chip::Ov5640 => &[reads!(0x3108 0x3039 0x3036 0x3037 0x3034 0x3037 0x3035), OMNIVISION],
        Chip::Hm01b0 => &[reads!(
            0x3010 0x0383 0x0387 0x3060 0x3067 0x0342 0x0343 0x0340 0x0341 0x0202 0x0203 0x2100 0x0101 0x0101
        )],
        Chip::Hm0360 => &[reads!(
            0x3024 0x3030 0x0380 0x0381 0x0342 0x0343 0x0300 0x0340 0x0341 0x0202 0x0203 0x2000 0x0101 0x0101
        )],
        Chip::Gc0308 => &[
            reads!(0xfe 0x0b 0x0c 0x09 0x0a 0x0f 0x01 0x12 0x0f 0x02 0x0d 0x0e 0x46 0x4b 0x4c 0x49 0x4a),
            &[Page(0xfe, 1)],
            reads!(0x54 0x56 0x57 0x54 0x58 0x59),
            &[Page(0xfe, 0)],
            reads!(0x28 0x03 0x04 0x22 0x14 0x14 0x07 0x08 0x05 0x06),
        ],
        Chip::Gc2145 => &[reads!(
            0xfe 0x0f 0x10 0x0d 0x0e 0xfd 0x99 0x9b 0x9c 0x9d 0x9e 0x99 0x9f 0xa0 0xa1 0xa2 0x90 0x97 0x98 0x95 0x96 0xfa
            0x05 0x06 0x11 0x12 0xf8 0x07 0x08 0x03 0x04 0xb6 0x17 0x17 0x0b 0x0c 0x09 0x0a
        )],
        Chip::Mt9m114 => &[reads!(
            0xc980 0xc982 0xc980 0xc808 0xc80a 0xc800 0xc804 0xc834 0xc834 0xc858 0xc85a 0x300c 0x300a 0x3012 0xa804 0xc834
            0xc834 0xc868 0xc86a 0xc802 0xc854 0xc856
        )],
        other => panic!("{} is not here", other.name()),
    }
}

fn bytes(value: u16, wide: bool) -> Vec<u8> {
    if wide { value.to_be_bytes().to_vec() } else { vec![value as u8] }
}

/// The accesses as they go over the wire, with what the chip holds.
fn transactions_of(fake: &FakeSensor, accesses: &[&[Access]]) -> Vec<Transaction> {
    let Wiring { wide_address, wide_data, repeated_start, page_address } = fake.wiring;
    let (mut page, mut transactions) = (fake.page(), Vec::new());
    for access in accesses.iter().copied().flatten() {
        match *access {
            Access::Read(address) => {
                let value = if page_address == Some(address) { page } else { fake.value(page, address) };
                let (address, value) = (bytes(address, wide_address), bytes(value, wide_data));
                if repeated_start {
                    transactions.push(Transaction::write_read(fake.at, address, value));
                } else {
                    // A transaction of its own each: a stop in between.
                    transactions.push(Transaction::write(fake.at, address));
                    transactions.push(Transaction::read(fake.at, value));
                }
            }
            Page(address, value) => {
                page = value;
                let frame = [bytes(address, wide_address), bytes(value, wide_data)].concat();
                transactions.push(Transaction::write(fake.at, frame));
            }
        }
    }
    transactions
}

/// What a case's chip is asked when its mode is read for the first time.
pub(crate) fn of_identity_and_mode(case: &Case) -> Vec<Transaction> {
    let fake = (case.sensor)();
    let mut transactions = transactions_of(&fake, identity(case.chip));
    transactions.extend(transactions_of(&fake, mode(case.chip)));
    transactions
}

/// Cases whose registers are read in another order: more of them, or from another page.
const OTHERWISE: [&str; 2] = ["OV7670, QVGA", "GC0308, two"];

#[test]
fn each_chip_is_asked_transaction_by_transaction() {
    let mut asked = Vec::new();
    for case in CASES.iter().filter(|case| !OTHERWISE.iter().any(|name| case.name.starts_with(name))) {
        // The address of HM0360 that is tried first is another one there.
        if (case.sensor)().at != case.chip.addresses()[0] {
            continue;
        }
        let mut mock = Mock::new(&of_identity_and_mode(case));
        let mut sensor = Sensor::new(&mut mock, case.chip, case.clock_hz).expect(case.name);
        assert_eq!(sensor.mode().expect(case.name), case.mode(), "{}", case.name);
        sensor.release().done();
        asked.push(case.chip);
    }
    assert!(Chip::ALL.iter().all(|chip| asked.contains(chip)));
}

#[test]
fn scaling_by_hand_and_another_page_add_what_they_need() {
    let case =
        |name: &str| CASES.iter().find(|case| case.name.starts_with(name)).unwrap_or_else(|| panic!("no {name}"));
    let run = |name: &str, accesses: &[&[Access]]| {
        let case = case(name);
        let mut mock = Mock::new(&transactions_of(&(case.sensor)(), accesses));
        let mut sensor = Sensor::new(&mut mock, case.chip, case.clock_hz).expect(name);
        assert_eq!(sensor.mode().expect(name), case.mode(), "{name}");
        sensor.release().done();
    };
    let ov7670 = reads!(
        0x12 0x11 0x6b 0x17 0x32 0x18 0x32 0x19 0x03 0x1a 0x03 0x0c 0x3e 0x72 0x2a 0x2b 0x2e 0x2d 0x93 0x92 0x07 0x10 0x04
        0x13 0x1e 0x1e
    );
    run("OV7670, QVGA", &[identity(Chip::Ov7670)[0], ov7670]);
    let (page_0, page_1): (&[Access], &[Access]) = (&[Page(0xfe, 0)], &[Page(0xfe, 1)]);
    run(
        "GC0308, two",
        &[
            reads!(0xfe),
            page_0,
            reads!(0x00),
            page_1,
            reads!(0xfe),
            page_0,
            reads!(0x0b 0x0c 0x09 0x0a 0x0f 0x01 0x12 0x0f 0x02 0x0d 0x0e 0x46),
            page_1,
            reads!(0x54 0x56 0x57 0x54 0x58 0x59),
            page_0,
            reads!(0x28 0x03 0x04 0x22 0x14 0x14 0x07 0x08 0x05 0x06),
            page_1,
        ],
    );
}

/// 250 lines on an OV7670: automatic exposure off, then its three registers, the other bits as they were.
#[test]
fn an_exposure_is_set_transaction_by_transaction() {
    let case = CASES.iter().find(|case| case.name.starts_with("OV7670, VGA")).expect("there");
    let mut expected = of_identity_and_mode(case);
    let read = |address: u8, value: u8| [Transaction::write(0x21, vec![address]), Transaction::read(0x21, vec![value])];
    let write = |address: u8, value: u8| Transaction::write(0x21, vec![address, value]);
    expected.extend(read(0x13, 0xe7));
    expected.push(write(0x13, 0xe6));
    // AECHH keeps its two upper bits, AECH has all eight, COM1 keeps six.
    expected.extend(read(0x07, 0x80));
    expected.push(write(0x07, 0x80));
    expected.push(write(0x10, 0x3e));
    expected.extend(read(0x04, 0x42));
    expected.push(write(0x04, 0x42));
    let mut mock = Mock::new(&expected);
    Sensor::new(&mut mock, case.chip, case.clock_hz)
        .and_then(|mut sensor| sensor.set_exposure_lines(250))
        .expect("a sound mode");
    mock.done();
}
