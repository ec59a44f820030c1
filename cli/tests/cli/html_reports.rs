//! `frame --report`: a page that needs no other file.

use crate::painting::{painted, png};
use crate::tool::{Folder, SETUP, number};

fn folder() -> Folder {
    Folder::new().with("setup.toml", SETUP).with("a.png", png(painted()))
}

fn page(folder: &Folder, rest: &[&str]) -> (String, serde_json::Value) {
    let arguments = ["frame", "--setup", "setup.toml", "--report", "out.html", "--json"];
    let document = folder.run(&[&arguments[..], rest].concat()).json();
    (String::from_utf8(folder.read("out.html")).expect("UTF-8"), document)
}

#[test]
fn all_that_is_known_of_a_frame_is_on_the_page() {
    let (page, document) = page(&folder(), &["a.png"]);
    assert!(page.starts_with("<!DOCTYPE html>\n") && page.ends_with("</html>\n"));
    let ranges = document["frames"][0]["ranges"].as_array().expect("ranges");
    let count = |what: &str| page.matches(what).count();
    assert_eq!((count("class=\"edge ok\""), count("class=\"position ok\""), count("<tr class=\"ok\">")), (6, 6, 6));
    assert_eq!(
        (ranges.len(), count("class=\"budget\""), count("<svg class=\"birds-eye\""), count("<image ")),
        (6, 6, 1, 1)
    );
    // With as many decimals as their sigma deserves.
    let cells = page.split("<td>").filter_map(|cell| cell.split_once(" ± ")?.0.parse().ok());
    let depths: Vec<f64> = cells.collect();
    for range in ranges {
        let depth_m = number(range, "depth_m");
        assert!(depths.iter().any(|told_m| (told_m - depth_m).abs() < 0.0005), "{depth_m} among {depths:?}");
        assert!(page.contains(&format!("<td>{:.1}</td>", number(range, "column_at_first_row"))));
    }
    // The picture itself, as it came.
    let (_, data) = page.split_once("href=\"data:image/png;base64,").expect("a picture");
    assert!(data.find('"').expect("its end") > 10_000);
    // Nothing from elsewhere, and nothing that runs.
    for foreign in ["http://", "https://", "<script", "url(", "@import", "<link", "<iframe"] {
        assert!(!page.contains(foreign), "{foreign}");
    }
}

/// Positions are in metres: nearer ones lie lower, those on the right to the right.
#[test]
fn the_birds_eye_view_is_to_scale() {
    let (page, document) = page(&folder(), &["a.png"]);
    let places: Vec<(f64, f64)> = page
        .split("<circle cx=\"")
        .skip(1)
        .map(|rest| {
            let mut numbers = rest.split('"');
            let x = numbers.next().expect("x").parse().expect("a number");
            (x, numbers.nth(1).expect("y").parse().expect("a number"))
        })
        .collect();
    let ranges = document["frames"][0]["ranges"].as_array().expect("ranges");
    let metres: Vec<(f64, f64)> = ranges
        .iter()
        .map(|range| (number(range, "bearing") * number(range, "depth_m"), number(range, "depth_m")))
        .collect();
    let (_, camera) = page.split_once("<path class=\"camera\" d=\"M").expect("the camera");
    let mut camera = camera.split(' ').map(|number| number.parse::<f64>());
    let camera = [camera.next(), camera.next()].map(|number| number.expect("two").expect("a number"));
    let px_per_m = (places[0].1 - places[5].1) / (metres[5].1 - metres[0].1);
    assert!(px_per_m > 10.0, "{places:?}");
    for (place, metre) in places.iter().zip(&metres) {
        assert!((place.0 - camera[0] - px_per_m * metre.0).abs() < 0.5, "{place:?} {metre:?}");
        assert!((camera[1] - place.1 - px_per_m * metre.1).abs() < 0.5, "{place:?} {metre:?}");
    }
}

/// Slowly, all is within a metre: lines of the grid every 20 cm, the third of which is no exact number.
#[test]
fn the_grid_is_labelled_in_its_own_steps() {
    let folder = folder().with("setup.toml", SETUP.replace("-1.5", "-0.3"));
    let (page, _) = page(&folder, &["a.png"]);
    let (_, above) = page.split_once("<svg class=\"birds-eye\"").expect("a view from above");
    let labels: Vec<&str> =
        above.split("</text>").filter_map(|rest| rest.rsplit_once('>')).map(|(_, text)| text).collect();
    for label in ["-0.6 m", "0.0 m", "0.2 m", "0.6 m"] {
        assert!(labels.contains(&label), "{label} is not in {labels:?}");
    }
    assert!(labels.iter().all(|label| label.len() <= "-0.6 m".len() || !label.ends_with(" m")), "{labels:?}");
}

#[test]
fn names_are_escaped() {
    let name = "<b onload='x'>&\"é.png";
    let folder = folder().with(name, png(painted()));
    let (page, _) = page(&folder, &[name]);
    assert!(page.contains("<h2>&lt;b onload=&#39;x&#39;&gt;&amp;&quot;é.png</h2>"), "{}", &page[..3000]);
    assert!(!page.contains("<b "));
}

#[test]
fn a_sequence_has_a_section_for_each_frame() {
    let folder = folder().with("b.png", png(image::GrayImage::new(640, 480)));
    let (page, _) = page(&folder, &["a.png", "b.png", "a.png", "--frame-interval-s", "0.04"]);
    assert_eq!((page.matches("<section").count(), page.matches("<svg class=\"birds-eye\"").count()), (3, 3));
    assert!(page.contains("<li>nearly all grey levels are 0 to 0 of 255"), "a hint");
}

/// A page of thousands of pictures is none to look at.
#[test]
fn frames_beyond_a_hundred_are_counted() {
    let setup = SETUP.replace("640", "32").replace("480", "24").replace("fx = 600", "fx = 30");
    let folder = Folder::new().with("setup.toml", setup).with("a.png", png(image::GrayImage::new(32, 24)));
    let (page, document) = page(&folder, &["a.png"; 103]);
    assert_eq!(document["frames"].as_array().map(Vec::len), Some(103));
    assert_eq!(page.matches("<section").count(), 100);
    assert!(page.contains("<p>3 further frames are not shown.</p>"));
}

#[test]
fn reports_that_are_refused() {
    let folder = folder().with("a.html", png(painted()));
    let run = |rest: &[&str]| folder.run(&[&["frame", "--setup", "setup.toml"], rest].concat());
    let outcome = run(&["a.html", "--report", "./a.html"]);
    assert_eq!((outcome.code, outcome.stdout.as_str()), (2, ""));
    assert!(outcome.stderr.contains("--report would replace a.html"), "{}", outcome.stderr);
    assert_eq!(run(&["a.png", "--report", "out.pdf"]).code, 2);
    let outcome = run(&["a.png", "--report", "no/such/folder.html"]);
    assert!(outcome.code == 1 && outcome.stderr.contains("writing no/such/folder.html"), "{}", outcome.stderr);
}
