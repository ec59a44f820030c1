//! Scenes of `sim`: what hides what, what is told of it, what is refused, and that the same bits come out everywhere.

use proptest::prelude::*;
use shutter_range::sim::{Background, Bar, Contour, Exposure, Object, Rail, Scene, Shading, Simulator, Texture, Truth};
use shutter_range::{Camera, Distortion, Intrinsics, ParameterError, Polarity, Readout, ReadoutDirection, Twist};

use crate::projection;
use crate::scenes::seeded;
use crate::simulator::{row_of, scene_of, simulator, still};

fn level_of(object: &Object) -> f32 {
    match object {
        Object::Bar(bar) => bar.level,
        Object::Rail(rail) => rail.level,
    }
}

/// A scene with everything in it, as the boards will render it.
fn busy_scene() -> Scene<6> {
    let texture = Texture { contrast: 25.0, cell: 0.08, seed: 7 };
    let mut scene = Scene::new(Background::textured(170.0, texture)).expect("sound background");
    let objects: [Object; 6] = [
        Bar::upright(-0.3, 1.5, 0.12, 30.0).into(),
        Bar::upright(0.02, 2.5, 0.01, 60.0).into(),
        Bar::upright(0.25, 4.0, 0.5, 220.0).between(-0.8, 0.6).into(),
        Bar::upright(0.1, 1.2, 0.05, 40.0).leaning(0.2).into(),
        Bar::upright(0.3, 0.9, 0.04, 90.0).into(),
        Rail { depth_m: 2.0, top_m: 0.4, bottom_m: 0.45, level: 110.0 }.into(),
    ];
    for object in objects {
        scene.push(object).expect("sound object");
    }
    scene
}

fn busy_parts() -> (Camera<f32>, Readout, Twist<f32>) {
    let camera = Camera::new(Intrinsics::centred(320, 240, 300.0), Distortion::NONE).expect("sound camera");
    let readout = Readout::from_line_time_ps(240, 130_000_000, ReadoutDirection::TopToBottom).expect("sound readout");
    let motion = Twist::new([1.2, 0.1, 0.6], [0.05, -0.2, 0.1], [0.05, 1.0, 0.1]).expect("sound motion");
    (camera, readout, motion)
}

fn busy<'a>(scene: &'a Scene<6>, seed: u64) -> Simulator<'a, 6> {
    let (camera, readout, motion) = busy_parts();
    let exposure = Exposure { time_s: 0.006, ..Exposure::default() };
    Simulator::new(scene, &camera, &readout, &motion, exposure, seed).expect("sound parameters")
}

/// FNV-1a of a QVGA frame. The same constant must come out on every board; it changes only with the physics.
#[test]
fn the_same_bits_everywhere() {
    let scene = busy_scene();
    let simulator = busy(&scene, 1);
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for row in 0..240 {
        for pixel in row_of(&simulator, row, 320) {
            hash = (hash ^ u64::from(pixel)).wrapping_mul(0x100_0000_01b3);
        }
    }
    assert_eq!(hash, BUSY_FRAME, "{hash:#x}");
}

const BUSY_FRAME: u64 = 0x1b5d_388d_5eea_fb3b;

#[test]
fn rows_can_be_rendered_in_any_order_and_length() {
    let scene = busy_scene();
    let simulator = busy(&scene, 1);
    let in_order: Vec<_> = (0..240).map(|row| row_of(&simulator, row, 320)).collect();
    for step in [7, 97, 239] {
        for index in 0..240 {
            let row = (index * step + 11) % 240;
            assert_eq!(row_of(&simulator, row, 320), in_order[usize::from(row)]);
        }
    }
    assert_eq!(row_of(&simulator, 100, 77), in_order[100][..77]);
    assert_eq!(row_of(&simulator, 100, 400)[..320], in_order[100]);
    assert_eq!(row_of(&simulator, 100, 400)[320..], [0; 80]);
    assert_eq!(row_of(&simulator, u16::MAX, 320), in_order[239]);
    assert!(row_of(&simulator, 0, 0).is_empty());
}

#[test]
fn seeds_and_frames_change_the_noise_alone() {
    let scene = busy_scene();
    let row = |seed, frame| row_of(&busy(&scene, seed).at_frame(frame, 0), 120, 320);
    let here = row(1, 0);
    assert_eq!(here, row(1, 0));
    for other in [row(2, 0), row(1, 1), row(u64::MAX, u32::MAX)] {
        // A sigma of 2 to 4 levels: hardly a fifth of 320 pixels has the same value again, and none differs by ten
        // sigma.
        assert!(here.iter().zip(&other).filter(|(a, b)| a != b).count() > 200, "other noise");
        assert!(here.iter().zip(&other).all(|(a, b)| a.abs_diff(*b) < 40), "the same scene");
    }
}

#[test]
fn nearer_bars_hide_farther_ones() {
    let near = Bar::upright(0.0, 1.0, 0.2, 50.0);
    let far = Bar::upright(0.05, 3.0, 0.6, 200.0);
    let other = Bar::upright(-0.05, 2.0, 0.3, 120.0);
    let world = still();
    let orders = [[near, far, other], [far, other, near], [other, near, far]];
    let frames = orders.map(|order| {
        let scene = scene_of(0.0, order.map(Object::from));
        row_of(&simulator(&scene, &world, ReadoutDirection::TopToBottom, Exposure::IDEAL), 200, 640)
    });
    let [first, rest @ ..] = &frames;
    for row in rest {
        assert_eq!(row, first);
    }
    // f = 600: near 259.5 to 379.5, far 289.5 to 409.5, other 244.5 to 334.5.
    for (column, level) in [(200, 0), (252, 120), (270, 50), (300, 50), (370, 50), (390, 200), (420, 0)] {
        assert_eq!(first[column], level, "column {column}");
    }
}

#[test]
fn later_ones_hide_earlier_ones_at_the_same_depth() {
    let at = |level| Bar::upright(0.0, 1.0, 0.2, level).into();
    let scene = scene_of(0.0, [at(10.0), at(20.0), Bar::upright(0.0, 2.0, 0.2, 5.0).into(), at(30.0)]);
    let levels: Vec<f32> = scene.objects().iter().map(level_of).collect();
    assert_eq!(levels, [5.0, 10.0, 20.0, 30.0]);
}

#[test]
fn rails_hide_and_are_hidden() {
    let rail = Rail { depth_m: 2.0, top_m: 0.1, bottom_m: 0.2, level: 77.0 };
    let (behind, before) = (Bar::upright(-0.1, 3.0, 0.3, 200.0), Bar::upright(0.1, 1.0, 0.1, 20.0));
    let scene = scene_of(0.0, [rail.into(), behind.into(), before.into()]);
    let simulator = simulator(&scene, &still(), ReadoutDirection::TopToBottom, Exposure::IDEAL);
    // f = 600: the rail covers rows 269.5 to 299.5.
    let (above, within) = (row_of(&simulator, 200, 640), row_of(&simulator, 285, 640));
    let (behind, before) = (259, 379);
    assert_eq!([above[10], above[behind], above[before]], [0, 200, 20]);
    assert_eq!([within[10], within[behind], within[before]], [77, 77, 20]);
    let truths: Vec<Truth> = simulator.truth().collect();
    let seen: Vec<_> = truths.iter().map(|truth| (truth.first_row, truth.last_row, truth.visible_rows)).collect();
    assert_eq!(seen, [(0, 479, 450), (0, 479, 450), (0, 479, 480), (0, 479, 480)]);
}

#[test]
fn thin_rods_keep_their_area() {
    // 0.3 px wide: of 200 grey levels 60 remain, spread over three or four pixels.
    let scene = scene_of(255.0, [Bar::upright(0.0123, 2.0, 0.001, 55.0).into()]);
    let simulator = simulator(&scene, &still(), ReadoutDirection::TopToBottom, Exposure::IDEAL);
    let missing: f64 = row_of(&simulator, 240, 640).iter().map(|&pixel| 255.0 - f64::from(pixel)).sum();
    assert!((missing - 60.0).abs() < 2.0, "rounding of four pixels to whole levels, at three sigma: {missing}");
}

#[test]
fn truth_names_the_edges() {
    let bar = Bar::upright(0.1, 2.0, 0.1, 20.0).between(-0.2, 0.3);
    let bright = Bar::upright(-0.2, 4.0, 0.2, 250.0).leaning(0.05);
    let unseen = Bar::upright(3.0, 1.0, 0.1, 0.0);
    let scene = scene_of(128.0, [bar.into(), bright.into(), unseen.into()]);
    let simulator = simulator(&scene, &still(), ReadoutDirection::TopToBottom, Exposure::IDEAL);
    let truths: Vec<Truth> = simulator.truth().collect();
    let [far_left, far_right, left, right] = truths.as_slice() else { panic!("four edges: {truths:?}") };
    let expected = [
        (far_left, -0.225, 4.0, Polarity::Rising, false),
        (far_right, -0.175, 4.0, Polarity::Falling, false),
        (left, 0.075, 2.0, Polarity::Falling, true),
        (right, 0.125, 2.0, Polarity::Rising, true),
    ];
    for (truth, bearing, depth_m, polarity, upright) in expected {
        // Rounding of the bars' single precision.
        assert!((truth.bearing - bearing).abs() < 1e-6 && (truth.depth_m - depth_m).abs() < 1e-6, "{truth:?}");
        assert_eq!((truth.polarity, truth.is_upright()), (polarity, upright), "{truth:?}");
    }
    // 239.5 − 600 · 0.1 and 239.5 + 600 · 0.15
    assert_eq!((left.first_row, left.last_row, left.visible_rows), (180, 329, 150));
}

#[test]
fn texture_is_infinitely_far_away() {
    let texture = Texture { contrast: 100.0, cell: 0.05, seed: 3 };
    let scene = Scene::<1>::new(Background::textured(128.0, texture)).expect("sound background");
    let row = |velocity_m_s, yaw_rate: f64, start_ns| {
        let world = projection::Scene { velocity_m_s, rate_rad_s: [0.0, yaw_rate, 0.0], ..still() };
        let simulator = simulator(&scene, &world, ReadoutDirection::TopToBottom, Exposure::IDEAL);
        row_of(&simulator.at_frame(0, start_ns), 0, 640)
    };
    let at_rest = row([0.0; 3], 0.0, 0);
    assert_eq!(at_rest, row([3.0, 0.0, 5.0], 0.0, 1_000_000_000));
    let contrast = at_rest.iter().max().zip(at_rest.iter().min()).map(|(most, least)| most - least);
    assert!(contrast > Some(80), "two fifths of the largest contrast or more: {at_rest:?}");
    // To the right by 30 px in the middle of the image.
    let turned = row([0.0; 3], f64::atan(30.0 / 600.0), 1_000_000_000);
    for column in 310..330 {
        let (here, there) = (turned[column], at_rest[column + 30]);
        // Cells of 30 px and 100 levels: 3 levels are a pixel.
        assert!(here.abs_diff(there) <= 3, "column {column}: {here} for {there}");
    }
    let other = Texture { seed: 4, ..texture };
    let other = Scene::<1>::new(Background::textured(128.0, other)).expect("sound background");
    let simulator = simulator(&other, &still(), ReadoutDirection::TopToBottom, Exposure::IDEAL);
    assert_ne!(row_of(&simulator, 0, 640), at_rest);
}

#[test]
fn nonsense_is_refused_by_name() {
    let name = |result: Result<(), ParameterError>| result.expect_err("nonsense").parameter;
    let mut scene = Scene::<2>::new(Background::plain(0.0)).expect("sound background");
    let bar = Bar::upright(0.0, 1.0, 0.1, 0.0);
    let rail = Rail { depth_m: 1.0, top_m: 0.0, bottom_m: 0.1, level: 0.0 };
    assert_eq!(name(scene.push(Bar { depth_m: 0.0, ..bar })), "depth_m");
    assert_eq!(name(scene.push(Bar { width_m: 0.0, ..bar })), "width_m");
    assert_eq!(name(scene.push(Bar { bearing: f32::NAN, ..bar })), "bearing");
    assert_eq!(name(scene.push(Bar { level: 256.0, ..bar })), "level");
    assert_eq!(name(scene.push(bar.leaning(f32::INFINITY))), "lean");
    assert_eq!(name(scene.push(bar.between(1.0, -1.0))), "top_m");
    assert_eq!(name(scene.push(bar.tapered(f32::NAN))), "taper");
    assert_eq!(name(scene.push(bar.bowed(f32::INFINITY))), "bow_m");
    assert_eq!(name(scene.push(bar.rough(-0.1, 0.1, 0))), "roughness_m");
    assert_eq!(name(scene.push(bar.rough(0.1, 0.0, 0))), "roughness_length_m");
    assert_eq!(name(scene.push(bar.lit_from(4.0, 0.0))), "light_rad");
    assert_eq!(name(scene.push(bar.lit_from(0.0, 1.1))), "ambient");
    assert_eq!(name(scene.push(bar.between(0.0, f32::INFINITY))), "bottom_m");
    assert_eq!(name(scene.push(Rail { depth_m: -1.0, ..rail })), "depth_m");
    assert_eq!(name(scene.push(Rail { top_m: f32::NAN, ..rail })), "top_m");
    assert!(scene.objects().is_empty());
    scene.push(bar).and(scene.push(rail)).expect("room for two");
    assert_eq!(name(scene.push(bar)), "objects");

    let background = |level, texture| Scene::<1>::new(Background { level, texture }).map(|_| ());
    assert_eq!(name(background(-1.0, Texture::NONE)), "level");
    assert_eq!(name(background(0.0, Texture { cell: 0.0, ..Texture::NONE })), "cell");
    assert_eq!(name(background(0.0, Texture { contrast: f32::NAN, ..Texture::NONE })), "contrast");

    let (camera, readout, motion) = busy_parts();
    let with = |camera: &Camera<f32>, readout: &Readout, exposure: Exposure| {
        Simulator::new(&scene, camera, readout, &motion, exposure, 0).map(|_| ())
    };
    let barrel = Distortion::from_opencv([-0.1, 0.0, 0.0, 0.0, 0.0]);
    let barrel = Camera::new(*camera.intrinsics(), barrel).expect("sound camera");
    let other = Readout::from_line_time_ps(241, 1_000_000, ReadoutDirection::TopToBottom).expect("sound readout");
    let ideal = Exposure::IDEAL;
    assert_eq!(name(with(&barrel, &readout, ideal)), "distortion");
    assert_eq!(name(with(&camera, &other, ideal)), "rows of the readout");
    assert_eq!(name(with(&camera, &readout, Exposure { time_s: -1.0, ..ideal })), "time_s");
    assert_eq!(name(with(&camera, &readout, Exposure { psf_sigma_px: f32::NAN, ..ideal })), "psf_sigma_px");
    assert_eq!(name(with(&camera, &readout, Exposure { read_noise: -1.0, ..ideal })), "read_noise");
    assert_eq!(name(with(&camera, &readout, Exposure { shot_gain: 101.0, ..ideal })), "shot_gain");
    let simulator = Simulator::new(&scene, &camera, &readout, &motion, ideal, 0).expect("sound parameters");
    assert_eq!(name(simulator.with_corner_blur(-0.5).map(|_| ())), "psf_sigma_px");
}

#[test]
fn scenes_are_checked_again_when_read() {
    let scene = busy_scene();
    let text = serde_json::to_string(&scene).expect("writes");
    assert_eq!(serde_json::from_str::<Scene<6>>(&text).expect("reads"), scene);
    assert!(serde_json::from_str::<Scene<5>>(&text).is_err(), "too many");
    let broken = text.replace("\"width_m\":0.5", "\"width_m\":-0.5");
    assert!(broken != text && serde_json::from_str::<Scene<6>>(&broken).is_err(), "negative width");
    // As written before bars had contours and shadings.
    let plain = serde_json::to_string(&Contour::STRAIGHT).expect("writes");
    let older = text.replace(&format!(",\"contour\":{plain},\"shading\":\"Flat\""), "");
    assert!(older.len() + 300 < text.len(), "{text}");
    assert_eq!(serde_json::from_str::<Scene<6>>(&older).expect("reads"), scene);
}

/// Moderate numbers, zero and the ends of what is accepted.
fn any_of(limit: f32) -> impl Strategy<Value = f32> {
    prop_oneof![-limit..=limit, -1.0..=1.0_f32, Just(0.0), Just(limit), Just(-limit)]
}

fn vectors(limit: f32) -> impl Strategy<Value = [f32; 3]> {
    [any_of(limit), any_of(limit), any_of(limit)]
}

fn contours() -> impl Strategy<Value = Contour> {
    let roughness = prop_oneof![Just(0.0), 0.0..=1e6_f32, 0.0..=0.01_f32];
    let length = prop_oneof![1e-4..=1e6_f32, Just(1e-4)];
    let contour = (any_of(10.0), any_of(1e6), roughness, length, any::<u32>()).prop_map(
        |(taper, bow_m, roughness_m, roughness_length_m, seed)| Contour {
            taper,
            bow_m,
            roughness_m,
            roughness_length_m,
            seed,
        },
    );
    prop_oneof![Just(Contour::STRAIGHT), contour]
}

fn shadings() -> impl Strategy<Value = Shading> {
    let cylinder = (-core::f32::consts::PI..=core::f32::consts::PI, 0.0..=1.0_f32)
        .prop_map(|(light_rad, ambient)| Shading::Cylinder { light_rad, ambient });
    prop_oneof![Just(Shading::Flat), cylinder]
}

fn is_shaded(object: &Object) -> bool {
    matches!(object, Object::Bar(bar) if bar.shading != Shading::Flat)
}

fn objects() -> impl Strategy<Value = Object> {
    let depth = || prop_oneof![0.01..=1e6_f32, 0.01..=3.0_f32, Just(0.01), Just(1e6)];
    let ends = || (any_of(1e6), any_of(1e6)).prop_map(|(a, b)| (a.min(b), a.max(b)));
    let width = prop_oneof![1e-30..=1e6_f32, 0.01..=1.0_f32];
    let bar = (any_of(100.0), depth(), width, ends(), any_of(10.0), 0.0..=255.0_f32, contours(), shadings()).prop_map(
        |(bearing, depth_m, width_m, (top_m, bottom_m), lean, level, contour, shading)| {
            Object::Bar(Bar { bearing, depth_m, width_m, top_m, bottom_m, lean, level, contour, shading })
        },
    );
    let rail = (depth(), ends(), 0.0..=255.0_f32)
        .prop_map(|(depth_m, (top_m, bottom_m), level)| Object::Rail(Rail { depth_m, top_m, bottom_m, level }));
    prop_oneof![bar, rail]
}

proptest! {
    #![proptest_config(seeded(2000))]

    /// Without a panic, and between the levels of the scene.
    #[test]
    fn all_that_is_accepted_can_be_rendered(
        objects in prop::collection::vec(objects(), 0..5),
        (background, contrast, cell) in (0.0..=255.0_f32, 0.0..=255.0_f32, 1e-4..=10.0_f32),
        (velocity, rate, gravity) in (vectors(10_000.0), vectors(1_000.0), vectors(1.0)),
        (time_s, psf_sigma_px) in (prop_oneof![0.0..=60.0_f32, 0.0..=0.01_f32, Just(1e-30)], 0.0..=20.0_f32),
        (read_noise, shot_gain, seed) in (0.0..=100.0_f32, 0.0..=100.0_f32, any::<u64>()),
        (frame, start_ns) in (any::<u32>(), prop_oneof![any::<i64>(), -1_000_000_000..1_000_000_000_i64]),
        (focal, row) in (prop_oneof![1.0..=1e6_f32, 10.0..=100.0_f32], any::<u16>()),
    ) {
        prop_assume!(gravity.iter().any(|component| component.abs() > 0.01));
        let texture = Texture { contrast, cell, seed: 5 };
        let mut scene = Scene::<4>::new(Background::textured(background, texture)).expect("in range");
        for object in objects {
            scene.push(object).expect("in range");
        }
        let camera = Camera::new(Intrinsics::centred(32, 24, focal), Distortion::NONE).expect("in range");
        let readout = Readout::from_line_time_ps(24, 100_000_000, ReadoutDirection::TopToBottom).expect("in range");
        let motion = Twist::new(velocity, rate, gravity).expect("in range");
        let noisy = Exposure { time_s, psf_sigma_px, read_noise, shot_gain };
        let quiet = Exposure { read_noise: 0.0, shot_gain: 0.0, ..noisy };
        for exposure in [noisy, quiet] {
            let simulator = Simulator::new(&scene, &camera, &readout, &motion, exposure, seed).expect("in range");
            let simulator = simulator.at_frame(frame, start_ns);
            let _ = simulator.motion();
            for truth in simulator.truth() {
                prop_assert!(truth.bearing.is_finite() && truth.depth_m > 0.0 && truth.first_row <= truth.last_row);
                prop_assert!(truth.visible_rows <= 24);
            }
            let pixels = row_of(&simulator, row, 32);
            let black = scene.objects().iter().any(is_shaded).then_some(0.0);
            let levels = scene.objects().iter().map(level_of).chain(black);
            let texture = (background - contrast, background + contrast);
            let (least, most) = levels.fold(texture, |(least, most), level| (least.min(level), most.max(level)));
            if exposure == quiet {
                for pixel in pixels.into_iter().map(f32::from) {
                    prop_assert!(least - 1.0 < pixel && pixel < most + 1.0, "{} of {}..{}", pixel, least, most);
                }
            }
        }
    }
}
