//! The scenarios: what stands where, how the camera moves, and how much of that differs from frame to frame.

use shutter_range::ParameterError;
use shutter_range::sim::{Background, Bar, Rail, Scene, Texture};

use crate::{Draw, Rig, Shot};

/// A kind of frame, drawn at random.
pub struct Scenario {
    pub name: &'static str,
    shot: fn(&mut Draw) -> Result<Shot, ParameterError>,
}

impl Scenario {
    /// The frame of this number.
    pub fn shot(&self, seed: u64, frame: u32) -> Result<Shot, ParameterError> {
        (self.shot)(&mut Draw::new(seed, self.name, frame))
    }
}

pub const SCENARIOS: [Scenario; 22] = [
    Scenario { name: "1080p rod, 5 m", shot: |draw| rod(draw, Rig::HD, 5.0) },
    Scenario { name: "1080p rod, 10 m", shot: |draw| rod(draw, Rig::HD, 10.0) },
    Scenario { name: "1080p rod, 15 m", shot: |draw| rod(draw, Rig::HD, 15.0) },
    Scenario { name: "QVGA 1 m", shot: |draw| bar(draw, Rig::QVGA, 1.0) },
    Scenario { name: "QVGA 2 m", shot: |draw| bar(draw, Rig::QVGA, 2.0) },
    Scenario { name: "QVGA 5 m", shot: |draw| bar(draw, Rig::QVGA, 5.0) },
    Scenario { name: "VGA 2 m", shot: |draw| bar(draw, Rig::VGA, 2.0) },
    Scenario { name: "VGA 5 m", shot: |draw| bar(draw, Rig::VGA, 5.0) },
    Scenario { name: "heading 30°", shot: |draw| heading(draw, 30.0) },
    Scenario { name: "heading 60°", shot: |draw| heading(draw, 60.0) },
    Scenario { name: "ahead", shot: ahead },
    Scenario { name: "contrast 15", shot: low_contrast },
    Scenario { name: "noise 12", shot: noisy },
    Scenario { name: "blur 16-28 px", shot: long_blur },
    Scenario { name: "five bars", shot: five_bars },
    Scenario { name: "occlusion", shot: occlusion },
    Scenario { name: "clutter", shot: |draw| clutter(draw, Rig::VGA, 1) },
    Scenario { name: "1080p clutter", shot: |draw| clutter(draw, Rig::HD, 1) },
    Scenario { name: "flat", shot: flat },
    Scenario { name: "texture", shot: |draw| texture(draw, Rig::VGA) },
    Scenario { name: "1080p texture", shot: |draw| texture(draw, Rig::HD) },
    Scenario { name: "leaning", shot: leaning },
];

/// Grey levels between dark and bright.
const CONTRAST: f32 = 110.0;
/// The level halfway between the two.
const MIDDLE: f32 = 115.0;

/// Levels of background and object: dark before bright, or the other way round.
fn levels(draw: &mut Draw, contrast: f32) -> (f32, f32) {
    let half = 0.5 * contrast * draw.sign();
    (MIDDLE - half, MIDDLE + half)
}

/// To the left or to the right at 1 to 3 m/s.
fn sideways(draw: &mut Draw) -> [f32; 3] {
    [draw.sign() * draw.within(1.0, 3.0), 0.0, 0.0]
}

/// Far enough from the borders for the skew of a frame.
fn bearing(draw: &mut Draw, rig: &Rig) -> f32 {
    0.55 * rig.half_field() * draw.within(-1.0, 1.0)
}

/// 12 cm wide and 1 m high.
fn post(bearing: f32, depth_m: f32, level: f32) -> Bar {
    Bar::upright(bearing, depth_m, 0.12, level).between(-0.5, 0.5)
}

fn shot(draw: &mut Draw, rig: Rig, scene: Scene<32>, velocity_m_s: [f32; 3]) -> Shot {
    Shot { rig, scene, velocity_m_s, seed: draw.number().into() }
}

fn of_bars(background: Background, bars: impl IntoIterator<Item = Bar>) -> Result<Scene<32>, ParameterError> {
    let mut scene = Scene::new(background)?;
    bars.into_iter().try_for_each(|bar| scene.push(bar))?;
    Ok(scene)
}

/// The paper's: 5 cm wide, 2 m high, passed by at 8 to 13.6 m/s.
pub fn rod(draw: &mut Draw, rig: Rig, depth_m: f32) -> Result<Shot, ParameterError> {
    let (behind, level) = levels(draw, CONTRAST);
    let rod = Bar::upright(bearing(draw, &rig), draw.about(depth_m), 0.05, level).between(-1.0, 1.0);
    let velocity_m_s = [draw.sign() * draw.within(8.0, 13.6), 0.0, 0.0];
    Ok(shot(draw, rig, of_bars(Background::plain(behind), [rod])?, velocity_m_s))
}

fn bar(draw: &mut Draw, rig: Rig, depth_m: f32) -> Result<Shot, ParameterError> {
    let velocity_m_s = sideways(draw);
    bar_of(draw, rig, depth_m, CONTRAST, velocity_m_s)
}

fn bar_of(
    draw: &mut Draw,
    rig: Rig,
    depth_m: f32,
    contrast: f32,
    velocity_m_s: [f32; 3],
) -> Result<Shot, ParameterError> {
    let (behind, level) = levels(draw, contrast);
    let post = post(bearing(draw, &rig), draw.about(depth_m), level);
    Ok(shot(draw, rig, of_bars(Background::plain(behind), [post])?, velocity_m_s))
}

/// Forward at an angle to the image plane.
fn heading(draw: &mut Draw, degrees: f32) -> Result<Shot, ParameterError> {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    let [speed, ..] = sideways(draw);
    bar_of(draw, Rig::VGA, 2.0, CONTRAST, [speed * cosine, 0.0, speed.abs() * sine])
}

/// Straight ahead there is no skew in the middle of the image.
fn ahead(draw: &mut Draw) -> Result<Shot, ParameterError> {
    let rig = Rig::VGA;
    let (behind, level) = levels(draw, CONTRAST);
    let bearing = draw.sign() * rig.half_field() * draw.within(0.5, 0.8);
    let post = post(bearing, draw.about(2.0), level);
    let velocity_m_s = [0.0, 0.0, draw.within(1.0, 3.0)];
    Ok(shot(draw, rig, of_bars(Background::plain(behind), [post])?, velocity_m_s))
}

fn low_contrast(draw: &mut Draw) -> Result<Shot, ParameterError> {
    let velocity_m_s = sideways(draw);
    bar_of(draw, Rig::VGA, 2.0, 15.0, velocity_m_s)
}

fn noisy(draw: &mut Draw) -> Result<Shot, ParameterError> {
    let mut rig = Rig::VGA;
    (rig.exposure.read_noise, rig.exposure.shot_gain) = (12.0, 0.0);
    bar(draw, rig, 2.0)
}

/// As in the dark: an exposure during which the edge moves by 16 to 28 px.
fn long_blur(draw: &mut Draw) -> Result<Shot, ParameterError> {
    let mut rig = Rig::VGA;
    let speed = draw.within(2.0, 3.0);
    let blur_px = draw.within(16.0, 28.0);
    rig.exposure.time_s = blur_px * 2.0 / (rig.focal_px * speed);
    let velocity_m_s = [draw.sign() * speed, 0.0, 0.0];
    bar_of(draw, rig, 2.0, CONTRAST, velocity_m_s)
}

/// Side by side at 1.5 to 4 m.
fn five_bars(draw: &mut Draw) -> Result<Shot, ParameterError> {
    let (behind, level) = levels(draw, CONTRAST);
    let posts = [-0.36, -0.18, 0.0, 0.18, 0.36].map(|bearing: f32| {
        let bearing = bearing + draw.within(-0.02, 0.02);
        post(bearing, draw.within(1.5, 4.0), level)
    });
    let velocity_m_s = sideways(draw);
    Ok(shot(draw, Rig::VGA, of_bars(Background::plain(behind), posts)?, velocity_m_s))
}

/// A rail before the bar hides some 40 of its 300 rows.
fn occlusion(draw: &mut Draw) -> Result<Shot, ParameterError> {
    let mut shot = bar(draw, Rig::VGA, 2.0)?;
    let top_m = draw.within(-0.15, 0.05);
    shot.scene.push(Rail { depth_m: 1.5, top_m, bottom_m: top_m + 0.1, level: 20.0 })?;
    Ok(shot)
}

/// Bars that lean by 8° to 75° and texture; `posts` upright and darker ones stand before it all.
pub fn clutter(draw: &mut Draw, rig: Rig, posts: u8) -> Result<Shot, ParameterError> {
    let mut scene = Scene::new(textured(draw, &rig, 150.0))?;
    for _ in 0..24 {
        scene.push(leaning_bar(draw, &rig, [90.0, 230.0]))?;
    }
    // Each in its own part of the image.
    let part = 1.6 * rig.half_field() / f32::from(posts.max(1));
    for index in 0..posts {
        let from_middle = f32::from(index) + 0.5 - 0.5 * f32::from(posts);
        let bearing = part * (from_middle + draw.within(-0.2, 0.2));
        scene.push(post(bearing, draw.about(2.0), 30.0))?;
    }
    let velocity_m_s = sideways(draw);
    Ok(shot(draw, rig, scene, velocity_m_s))
}

/// Cells of about 12 px, up to 30 grey levels about the mean.
fn textured(draw: &mut Draw, rig: &Rig, level: f32) -> Background {
    Background::textured(level, Texture { contrast: 30.0, cell: 12.0 / rig.focal_px, seed: draw.number() })
}

fn leaning_bar(draw: &mut Draw, rig: &Rig, [darkest, brightest]: [f32; 2]) -> Bar {
    let lean = draw.sign() * draw.within(8.0, 75.0).to_radians().tan();
    let bearing = rig.half_field() * draw.within(-1.0, 1.0);
    let (depth_m, width_m) = (draw.within(2.5, 6.0), draw.within(0.03, 0.12));
    Bar::upright(bearing, depth_m, width_m, draw.within(darkest, brightest)).between(-0.7, 0.7).leaning(lean)
}

/// Nothing but noise.
fn flat(draw: &mut Draw) -> Result<Shot, ParameterError> {
    let scene = of_bars(Background::plain(draw.within(60.0, 200.0)), [])?;
    let velocity_m_s = sideways(draw);
    Ok(shot(draw, Rig::VGA, scene, velocity_m_s))
}

fn texture(draw: &mut Draw, rig: Rig) -> Result<Shot, ParameterError> {
    let scene = of_bars(textured(draw, &rig, 120.0), [])?;
    let velocity_m_s = sideways(draw);
    Ok(shot(draw, rig, scene, velocity_m_s))
}

/// Eight bars, none of them upright, before an even background.
fn leaning(draw: &mut Draw) -> Result<Shot, ParameterError> {
    let bars: Vec<_> = (0..8).map(|_| leaning_bar(draw, &Rig::VGA, [20.0, 90.0])).collect();
    let scene = of_bars(Background::plain(180.0), bars)?;
    let velocity_m_s = sideways(draw);
    Ok(shot(draw, Rig::VGA, scene, velocity_m_s))
}
