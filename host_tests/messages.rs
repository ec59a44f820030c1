//! `messages`: ranges in the fields of MAVLink and ROS messages, and the record's bytes.

use shutter_range::messages::{DistanceSensor, LaserScan, ObstacleDistance, RangeMessage, Reach, Record};
use shutter_range::{BoardRanger, EdgePoint, Range, RangeStatus, Setup, Sigmas, Twist, Uncertainty};

const FOCAL_PX: f64 = 600.0;
const SPEED_M_S: f64 = 1.5;

/// The range of a post whose points lie exactly where they should, with all that is uncertain at its default.
fn post(bearing: f64, depth_m: f64) -> Range<f32> {
    ranged(bearing, depth_m, Uncertainty::default())
}

fn ranged(bearing: f64, depth_m: f64, uncertainty: Uncertainty<f32>) -> Range<f32> {
    let setup = Setup::pinhole(640, 480, FOCAL_PX as f32, 33_300_000).expect("a sound setup");
    let setup = setup.with_uncertainty(uncertainty).expect("a sound uncertainty");
    let motion = Twist::level([-SPEED_M_S as f32, 0.0, 0.0]).expect("a sound motion");
    let mut ranger = BoardRanger::new();
    for row in 0..480 {
        let time_ns = setup.readout().row_time_ns(row);
        let column_px = 319.5 + FOCAL_PX * (bearing + SPEED_M_S / depth_m * time_ns as f64 * 1e-9);
        ranger.edge_point(&setup, EdgePoint::new(row, (column_px * 65536.0) as i32, time_ns)).expect("a sound point");
    }
    ranger.end_frame(&setup);
    ranger.next_range(&setup, &motion).expect("one line")
}

/// A post against the motion.
fn refused() -> Range<f32> {
    let range = post(0.1, -1.0);
    assert_eq!(range.status, RangeStatus::Inconsistent);
    range
}

fn far() -> Range<f32> {
    let range = post(0.1, 500.0);
    assert_eq!(range.status, RangeStatus::Far);
    range
}

fn reach(max_m: f32) -> Reach {
    Reach::new(0.2, max_m).expect("a sound reach")
}

const AHEAD: [f32; 4] = [1.0, 0.0, 0.0, 0.0];

/// Shortest distance to an upright edge.
fn distance(bearing: f64, depth_m: f64) -> f64 {
    depth_m * (1.0 + bearing * bearing).sqrt()
}

#[test]
fn distance_sensor_has_centimetres_and_a_variance() {
    let range = post(0.1, 2.0);
    let (_, sigma_m) = range.distance(Sigmas(2.0)).estimate_m.expect("ok");
    let message = DistanceSensor::of_range(&range, &reach(20.0), AHEAD);
    let variance = (sigma_m * 100.0).powi(2);
    assert!(message.covariance >= 1 && (f32::from(message.covariance) - variance) < 1.0, "{message:?}, {variance}");
    assert!(f32::from(message.covariance) >= variance, "rounded up: {message:?}, {variance}");
    assert_eq!((message.min_distance, message.max_distance, message.signal_quality), (20, 2000, 100));
    assert_eq!(message.current_distance, (distance(0.1, 2.0) * 100.0).round() as u16);
    // Exactly known is not what zero would say.
    let exact = DistanceSensor::of_range(&ranged(0.1, 2.0, Uncertainty::NONE), &reach(20.0), AHEAD);
    assert_eq!(exact.covariance, 1);
    // A sigma of more than 15.9 cm does not fit.
    let vague = post(0.1, 6.0);
    assert!(vague.distance(Sigmas(2.0)).estimate_m.is_some_and(|(_, sigma_m)| sigma_m > 0.16), "{vague:?}");
    let message = DistanceSensor::of_range(&vague, &reach(20.0), AHEAD);
    assert_eq!((message.covariance, message.signal_quality), (255, 100));
}

#[test]
fn distance_sensor_without_a_distance() {
    let of = |range: &Range<f32>, max_m| {
        let message = DistanceSensor::of_range(range, &reach(max_m), AHEAD);
        (message.current_distance, message.covariance, message.signal_quality)
    };
    assert_eq!(of(&refused(), 20.0), (2001, 255, 1));
    // Its lower bound is beyond 10 m, but not beyond 200 m.
    assert_eq!(of(&far(), 10.0), (1001, 255, 100));
    assert_eq!(of(&far(), 200.0), (20_001, 255, 1));
    assert_eq!(of(&post(0.1, 3.0), 2.0), (201, 255, 100));
    // The largest reach leaves room for both.
    assert_eq!(of(&refused(), 655.33).0, 65_534);
}

/// The quaternion turns the body's nose to the edge: forward, right and down.
#[test]
fn distance_sensor_looks_at_the_edge() {
    let nose = |[w, x, y, z]: [f32; 4]| {
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)].map(f64::from)
    };
    let half = core::f32::consts::FRAC_PI_4;
    let looks = |camera| nose(DistanceSensor::of_range(&post(0.25, 2.0), &reach(20.0), camera).quaternion);
    let length = (1.0_f64 + 0.25 * 0.25).sqrt();
    let near = |found: [f64; 3], expected: [f64; 3]| {
        let worst = found.iter().zip(expected).fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs()));
        assert!(worst < 1e-4, "{found:?} for {expected:?}");
    };
    near(looks(AHEAD), [1.0 / length, 0.25 / length, 0.0]);
    // A camera that looks to the right sees on its right what is behind.
    near(looks([half.cos(), 0.0, 0.0, half.sin()]), [-0.25 / length, 1.0 / length, 0.0]);
    // One that looks up, too.
    near(looks([half.cos(), 0.0, half.sin(), 0.0]), [0.0, 0.25 / length, -1.0 / length]);
}

#[test]
fn obstacle_distance_has_the_nearest_of_each_sector() {
    let reach = reach(20.0);
    let mut message = ObstacleDistance::new(&reach, 90.0, 72.0);
    assert_eq!((message.increment, message.increment_f, message.angle_offset, message.frame), (1, 1.0, 54.5, 12));
    assert_eq!((message.min_distance, message.max_distance), (20, 2000));
    for range in [post(0.1, 3.0), post(0.1, 2.0), post(-0.2, 1.5), refused(), far()] {
        message.add(&range, &reach);
    }
    // 5.7° to the right of the axis and 11.3° to its left; the first sector begins 36° to its left.
    let expected =
        [(41, (distance(0.1, 2.0) * 100.0).round() as u16), (24, (distance(0.2, 1.5) * 100.0).round() as u16)];
    for (sector, distance) in (0..).zip(message.distances) {
        let known = expected.iter().find(|(known, _)| *known == sector).map(|(_, distance)| *distance);
        assert_eq!(distance, known.unwrap_or(65_535), "sector {sector}");
    }
    // Beside the sectors.
    let mut narrow = ObstacleDistance::new(&reach, 0.0, 2.0);
    [post(0.1, 2.0), post(-0.2, 1.5)].iter().for_each(|range| narrow.add(range, &reach));
    assert_eq!(narrow.distances, [65_535; 72]);
}

#[test]
fn ros_range_as_rep_117_says() {
    let of = |range: &Range<f32>, max_m| RangeMessage::of_range(range, &reach(max_m));
    let (range, far) = (post(0.1, 2.0), far());
    let (distance_m, sigma_m) = range.distance(Sigmas(2.0)).estimate_m.expect("ok");
    let message = of(&range, 20.0);
    assert_eq!((message.range, message.variance), (distance_m, sigma_m * sigma_m));
    assert_eq!((message.min_range, message.max_range), (0.2, 20.0));
    assert!(of(&ranged(0.1, 2.0, Uncertainty::NONE), 20.0).variance > 0.0, "zero would be unknown");
    assert_eq!((of(&post(0.1, 3.0), 2.0).range, of(&far, 10.0).range), (f32::INFINITY, f32::INFINITY));
    for nothing in [of(&refused(), 20.0), of(&far, 200.0)] {
        assert!(nothing.range.is_nan() && nothing.variance == 0.0, "{nothing:?}");
    }
    let near = RangeMessage::of_range(&range, &Reach::new(5.0, 20.0).expect("a sound reach"));
    assert_eq!((near.range, near.variance), (f32::NEG_INFINITY, 0.0));
}

#[test]
fn laser_scan_counts_to_the_left_and_claims_nothing() {
    let reach = reach(20.0);
    let mut scan = LaserScan::<91>::new(&reach, core::f32::consts::FRAC_PI_2).expect("a sound field");
    for range in [post(0.1, 3.0), post(0.1, 2.0), post(-0.2, 1.5), refused(), far()] {
        scan.add(&range, &reach);
    }
    for (beam, found) in (0..).zip(scan.ranges) {
        let expected = match beam {
            // 5.7° to the right and 11.3° to the left of the middle, beam 45.
            39 => distance(0.1, 2.0),
            56 => distance(0.2, 1.5),
            _ => f64::NAN,
        };
        let is_same = (f64::from(found) - expected).abs() < 1e-3 || found.is_nan() && expected.is_nan();
        assert!(is_same, "beam {beam}: {found}");
    }
    assert!((scan.angle_min + scan.angle_increment * 90.0 - scan.angle_max).abs() < 1e-6);
    assert!(LaserScan::<2>::new(&reach, f32::NAN).is_err() && LaserScan::<2>::new(&reach, 0.0).is_err());
}

#[test]
fn impossible_reaches() {
    for (min_m, max_m) in
        [(-1.0, 2.0), (f32::NAN, 2.0), (1.0, 1.0), (0.0, f32::NAN), (0.0, 656.0), (0.0, f32::INFINITY)]
    {
        assert!(Reach::new(min_m, max_m).is_err(), "{min_m} to {max_m}");
    }
}

/// Version 1, to the byte: whoever changes them needs a version 2.
#[test]
fn the_record_of_version_1() {
    let record = Record {
        frame: 300,
        line_id: Some(7),
        status: RangeStatus::Far,
        bearing: 0.5,
        inverse_depth_per_m: 0.25,
        sigma_inverse_depth_per_m: 1.0,
        points: 200,
    };
    let bytes = postcard::to_stdvec(&record).expect("a record");
    assert_eq!(bytes, [1, 0xAC, 2, 1, 7, 1, 0, 0, 0, 0x3F, 0, 0, 0x80, 0x3E, 0, 0, 0x80, 0x3F, 0xC8, 1]);
    assert_eq!(postcard::from_bytes(&bytes), Ok(record));
    let mut other = bytes;
    other[0] = 2;
    assert!(postcard::from_bytes::<Record>(&other).is_err(), "another version");
    let longest = Record { frame: u32::MAX, line_id: Some(u32::MAX), points: u16::MAX, ..record };
    assert_eq!(postcard::to_stdvec(&longest).expect("a record").len(), 28);
    let shortest = Record { frame: 0, line_id: None, points: 0, ..record };
    assert_eq!(postcard::to_stdvec(&shortest).expect("a record").len(), 17);
    let of_range = Record::of_range(&post(0.1, 2.0), 3);
    assert_eq!((of_range.frame, of_range.status, of_range.line_id), (3, RangeStatus::Ok, None));
    assert!((of_range.bearing - 0.1).abs() < 1e-4 && (of_range.inverse_depth_per_m - 0.5).abs() < 1e-3);
}
