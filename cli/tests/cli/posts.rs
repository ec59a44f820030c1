//! Two sides of one post: reported as belonging together, with the distance to its middle.

use std::fmt::Write;

use serde_json::Value;

use crate::simulations::{SCENE, simulate, with_setup};
use crate::tool::{Folder, SETUP, assert_near, number};

/// Lean of an edge in the image as a slope: positive is to the right downwards.
struct Side {
    bearing: f64,
    depth_m: f64,
    lean: f64,
    polarity: &'static str,
    rows: std::ops::Range<u32>,
}

fn side(bearing: f64, depth_m: f64, lean: f64, polarity: &'static str) -> Side {
    Side { bearing, depth_m, lean, polarity, rows: 0..480 }
}

fn ranges(setup: &str, sides: &[Side]) -> Vec<Value> {
    let mut text = "row,column,line,polarity\n".to_string();
    for (number, side) in sides.iter().enumerate() {
        for row in side.rows.clone() {
            let column = crate::tool::column(side.bearing, side.depth_m, row) + side.lean * (f64::from(row) - 239.5);
            let _ = writeln!(text, "{row},{column:.5},{number},{}", side.polarity);
        }
    }
    Folder::of(setup, &text).ranges()
}

fn uncertain() -> String {
    SETUP.replace("sigma_tilt_deg = 0", "sigma_tilt_deg = 0.1")
}

fn posts(ranges: &[Value]) -> Vec<Option<u64>> {
    ranges.iter().map(|range| range["post"].as_u64()).collect()
}

/// A lamp post that narrows by a third of a degree on each side, which is 28 % of the slope at 3 m.
#[test]
fn the_taper_of_a_post_cancels() {
    let taper = 0.34_f64.to_radians().tan();
    let sides = [side(0.1, 3.0, -taper, "falling"), side(0.13, 3.0, taper, "rising")];
    let setup = SETUP.replace("sigma_tilt_deg = 0", "sigma_tilt_deg = 0.35");
    let ranges = ranges(&setup, &sides);
    assert_eq!(posts(&ranges), [Some(1), Some(0)]);
    for range in &ranges {
        assert_near((number(range, "inverse_depth_per_m") * 3.0 - 1.0).abs(), 0.28, 0.01);
        let bearing = 0.115_f64;
        assert_near(number(range, "post_distance_m"), 3.0 * (1.0 + bearing * bearing).sqrt(), 0.01);
    }
}

/// What one side alone leaves open is left open by both: that the whole post leans.
#[test]
fn the_sigma_of_a_post_keeps_what_both_sides_share() {
    let sides = || [side(0.1, 3.0, 0.0, "falling"), side(0.13, 3.0, 0.0, "rising")];
    let relative = |setup: &str| {
        let range = ranges(setup, &sides()).remove(0);
        let alone = number(&range, "sigma_inverse_depth_per_m") / number(&range, "inverse_depth_per_m");
        (number(&range, "post_sigma_m") / number(&range, "post_distance_m"), alone)
    };
    let (post, alone) = relative(SETUP);
    assert_near(post / alone, 0.5_f64.sqrt(), 0.01);
    let (post, alone) = relative(&SETUP.replace("sigma_speed = 0", "sigma_speed = 0.1"));
    assert_near(post / alone, 1.0, 0.01);
    let (post, alone) = relative(&uncertain());
    assert_near(post / alone, 1.0, 0.01);
}

#[test]
fn edges_that_are_not_alike_and_opposite_are_no_post() {
    let rising = |bearing| side(bearing, 3.0, 0.0, "rising");
    let falling = |bearing| side(bearing, 3.0, 0.0, "falling");
    let alike = [rising(0.1), rising(0.13)];
    let unknown = [side(0.1, 3.0, 0.0, ""), side(0.13, 3.0, 0.0, "")];
    let of_other_ends = [Side { rows: 0..240, ..falling(0.1) }, rising(0.13)];
    let too_wide = [falling(-0.1), rising(0.13)];
    let at_other_depths = [falling(0.1), side(0.13, 1.5, 0.0, "rising")];
    // Narrower at its foot.
    let narrowing = [side(0.1, 3.0, 0.0, "falling"), side(0.13, 3.0, -0.006, "rising")];
    for sides in [alike, unknown, of_other_ends, too_wide, at_other_depths, narrowing] {
        let ranges = ranges(SETUP, &sides);
        assert_eq!(posts(&ranges), [None, None], "{ranges:?}");
        assert!(ranges.iter().all(|range| range["post_distance_m"].is_null() && range["post_sigma_m"].is_null()));
    }
}

/// The gap between two posts has opposite edges as well.
#[test]
fn the_sides_of_a_post_are_nearer_to_each_other_than_posts_are() {
    let post = |bearing: f64| [side(bearing, 3.0, 0.0, "falling"), side(bearing + 0.03, 3.0, 0.0, "rising")];
    let sides: Vec<_> = [-0.2, -0.1, 0.0].into_iter().flat_map(post).collect();
    assert_eq!(posts(&ranges(SETUP, &sides)), [Some(1), Some(0), Some(3), Some(2), Some(5), Some(4)]);
}

#[test]
fn what_is_far_is_a_post_without_a_distance() {
    let sides = [side(0.1, 1e5, 0.0, "falling"), side(0.13, 1e5, 0.0, "rising")];
    let ranges = ranges(SETUP, &sides);
    assert_eq!(posts(&ranges), [Some(1), Some(0)]);
    assert!(ranges.iter().all(|range| range["post_distance_m"].is_null()));
}

#[test]
fn the_posts_of_a_simulated_frame_are_found() {
    let folder = with_setup().with("scene.toml", SCENE);
    assert_eq!(simulate(&folder, &["--out", "out", "--scene", "scene.toml"]).code, 0);
    let arguments = ["frame", "out/frame-0000.png", "--setup", "setup.toml"];
    let document = folder.run(&[&arguments[..], &["--json"]].concat()).json();
    let ranges = document["frames"][0]["ranges"].as_array().expect("ranges");
    assert_eq!(posts(ranges), [Some(1), Some(0), Some(3), Some(2)]);
    for (range, distance_m) in ranges.iter().zip([2.0 * 1.04_f64.sqrt(), 0.0, 3.0 * 1.0625_f64.sqrt()]).step_by(2) {
        assert_near(number(range, "post_distance_m"), distance_m, 4.0 * number(range, "post_sigma_m"));
    }
    let text = folder.run(&arguments).stdout;
    let lines: Vec<_> = text.lines().filter(|line| line.starts_with("post between ")).collect();
    assert!(lines.len() == 2 && lines[0].contains(": its middle is 2.0") && lines[0].ends_with(" m away"), "{text}");
}
