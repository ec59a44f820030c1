//! Frames that a camera has compressed: as many edges are found, sigma holds, and a known exposure makes nothing worse.

use std::fmt::Write;

use image::codecs::jpeg::JpegEncoder;
use serde_json::Value;

use crate::simulations::simulate;
use crate::tool::{Folder, SETUP, number};

const FRAMES: u32 = 24;

/// A generator of numbers that look random, the same in every run (Steele, Lea and Flood's SplitMix64).
struct Random(u64);

impl Random {
    /// 0 to 1.
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Of a variance of one.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// Four posts at 1 to 2.3 m, each with a lean of its own: the farthest has a slope of five sigmas of 0.3°.
fn scene(random: &mut Random, sigma_tilt_deg: f64) -> String {
    let mut text = "[background]\nlevel = 170\n".to_string();
    for place in [-0.4, -0.133, 0.133, 0.4] {
        let (depth_m, lean_deg) = (1.0 + 1.3 * random.uniform(), sigma_tilt_deg * random.normal());
        let bearing = place + 0.02 * random.uniform();
        let _ = write!(
            text,
            "[[bar]]\nbearing = {bearing}\ndepth_m = {depth_m}\nwidth_m = 0.12\nlevel = 60\nlean_deg = {lean_deg}\n"
        );
    }
    text
}

fn setup(sigma_tilt_deg: f64, exposure: &str) -> String {
    SETUP
        .replace("sigma_tilt_deg = 0", &format!("sigma_tilt_deg = {sigma_tilt_deg}"))
        .replace("edge_roughness_px = 0\n", exposure)
}

const EXPOSURE: &str = "exposure_s = 0.006\nlens_blur_px = 0.7\n";

/// Frames with their truth: compressed, to be read with and without their exposure.
struct Frames {
    folder: Folder,
    /// For each frame its edges.
    truth: Vec<Vec<Value>>,
    sigma_tilt_deg: f64,
}

impl Frames {
    fn new(sigma_tilt_deg: f64) -> Self {
        let mut random = Random(1);
        let mut folder = Folder::new()
            .with("setup.toml", setup(sigma_tilt_deg, EXPOSURE))
            .with("unaware.toml", setup(sigma_tilt_deg, ""));
        let mut truth = Vec::new();
        for frame in 0..FRAMES {
            folder = folder.with("scene.toml", scene(&mut random, sigma_tilt_deg));
            let (out, seed) = (format!("out{frame}"), frame.to_string());
            let simulated = simulate(&folder, &["--out", &out, "--scene", "scene.toml", "--seed", &seed, "--json"]);
            truth.push(simulated.json()["frames"][0]["edges"].as_array().expect("edges").clone());
        }
        Self { folder, truth, sigma_tilt_deg }
    }

    /// Compresses all frames.
    fn at(mut self, quality: u8) -> Self {
        for frame in 0..FRAMES {
            let png = self.folder.read(&format!("out{frame}/frame-0000.png"));
            let picture = image::load_from_memory(&png).expect("a frame");
            let mut jpeg = Vec::new();
            picture.write_with_encoder(JpegEncoder::new_with_quality(&mut jpeg, quality)).expect("encoding a JPEG");
            self.folder = self.folder.with(&format!("{frame}.jpg"), jpeg);
        }
        self
    }

    /// For each edge, if it is found, its error relative to its inverse depth and in sigmas.
    fn errors(&self, setup: &str) -> Vec<Option<[f64; 2]>> {
        let files: Vec<_> = (0..FRAMES).map(|frame| format!("{frame}.jpg")).collect();
        let files = files.iter().map(String::as_str);
        let arguments: Vec<_> = ["frame", "--setup", setup, "--json"].into_iter().chain(files).collect();
        let document = self.folder.run(&arguments).json();
        let frames = document["frames"].as_array().expect("frames");
        let pairs = self.truth.iter().zip(frames);
        pairs.flat_map(|(edges, frame)| edges.iter().map(|edge| error(edge, &frame["ranges"]))).collect()
    }
}

/// Of the `ok` range that belongs to an edge.
fn error(edge: &Value, ranges: &Value) -> Option<[f64; 2]> {
    let is_of = |range: &&Value| {
        let off = (number(range, "bearing") - number(edge, "bearing")).abs();
        range["status"] == "ok" && range["polarity"] == edge["polarity"] && off < 0.02
    };
    let range = ranges.as_array().expect("ranges").iter().find(is_of)?;
    let off = number(range, "inverse_depth_per_m") - 1.0 / number(edge, "depth_m");
    Some([off * number(edge, "depth_m"), off / number(range, "sigma_inverse_depth_per_m")])
}

fn rms(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = values.clone().count() as f64;
    (values.map(|value| value * value).sum::<f64>() / count).sqrt()
}

/// What is found of 192 edges, and how honest it is.
#[track_caller]
fn assert_honest(name: &str, errors: &[Option<[f64; 2]>]) {
    let found: Vec<_> = errors.iter().flatten().collect();
    let share = found.len() as f64 / errors.len() as f64;
    let inside = found.iter().filter(|[_, sigmas]| sigmas.abs() <= 2.0).count() as f64 / found.len() as f64;
    let honest = rms(found.iter().map(|[_, sigmas]| *sigmas));
    println!("{name}: {:.1} % found, {:.1} % in two sigma, error/sigma {honest:.2}", 100.0 * share, 100.0 * inside);
    assert!(errors.len() == 192 && share >= 0.97, "{name}: {share} found");
    assert!(inside >= 0.92 && (0.6..1.2).contains(&honest), "{name}: {inside} in two sigma, error/sigma {honest}");
}

fn assert_compressed_frames_are_as_good(sigma_tilt_deg: f64) {
    let mut frames = Frames::new(sigma_tilt_deg);
    for quality in [90, 70, 50] {
        frames = frames.at(quality);
        let name = format!("quality {quality}, {}°", frames.sigma_tilt_deg);
        let (known, unknown) = (frames.errors("setup.toml"), frames.errors("unaware.toml"));
        assert_honest(&format!("{name}, exposure known"), &known);
        assert_honest(&format!("{name}, exposure not known"), &unknown);
        let both = || known.iter().zip(&unknown).filter_map(|(known, unknown)| (*known).zip(*unknown));
        let ratio = rms(both().map(|([known, _], _)| known)) / rms(both().map(|(_, [unknown, _])| unknown));
        println!("{name}: RMS error with the exposure {ratio:.3} of that without");
        assert!(ratio <= 1.05, "{name}: {ratio}");
    }
}

#[test]
fn leans_of_a_tenth_of_a_degree() {
    assert_compressed_frames_are_as_good(0.1);
}

#[test]
fn leans_of_a_third_of_a_degree() {
    assert_compressed_frames_are_as_good(0.3);
}
