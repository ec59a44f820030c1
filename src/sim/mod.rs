//! A deterministic scene before a moving rolling-shutter camera, as rows of pixels: to start without a camera, and for
//! firmware to test itself.
//!
//! [`Scene`] holds upright and leaning bars, rods and rails before a background; [`Simulator`] moves a camera past it
//! and yields each pixel row with the blur of its exposure, that of the lens, shot noise and read noise;
//! [`Simulator::truth`] says where the edges really are. [`Bar`]s may be as the world has them: rough, bowed, tapered,
//! or round and lit from the side; and a [`Pipeline`] does to the rows what cameras do before they deliver them: tone
//! curves, sharpening, denoising, a colour mosaic, the sensor's columns. Lamps may [`Flicker`]. [`Simulator::row_in`]
//! gives a row in any [`PixelFormat`](crate::format::PixelFormat). Any row comes out with the same bits, in any order,
//! on a desktop and on a board: a pixel depends on nothing but the parameters, the seed, the frame, the row and the
//! column.
//!
//! It is written from the physics and shares no formula with the estimator: it intersects the plane of a row's rays
//! with each edge in space, at the start, the middle and the end of the row's exposure. The blur has a closed form: the
//! box of the motion, convolved with the Gaussian of the lens and the box of the pixel. A nearer object hides that
//! share of what is behind a pixel which it covers.
//!
//! *Not rendered*: distortion (refused), blur and parallax of the background's texture, edges within 3° of a pixel row.
//!
//! ```
//! use shutter_range::sim::{Background, Bar, Exposure, Scene, Simulator};
//! use shutter_range::{Camera, Distortion, Intrinsics, Readout, ReadoutDirection, Twist};
//!
//! let mut scene = Scene::<4>::new(Background::plain(200.0))?;
//! scene.push(Bar::upright(0.0, 2.0, 0.1, 20.0))?; // straight ahead, 2 m away, 0.1 m wide, dark
//!
//! let camera = Camera::new(Intrinsics::centred(320, 240, 300.0), Distortion::NONE)?;
//! let readout = Readout::from_frame_readout_ns(240, 33_000_000, ReadoutDirection::TopToBottom)?;
//! let motion = Twist::level([1.5, 0.0, 0.0])?;
//! let simulator = Simulator::new(&scene, &camera, &readout, &motion, Exposure::default(), 1)?;
//!
//! let mut pixels = [0; 320];
//! simulator.row(0, &mut pixels);
//! assert!(pixels[10] > 180 && pixels[160] < 40);
//! let left = simulator.truth().next().expect("the bar's left edge");
//! assert!((left.bearing + 0.025).abs() < 1e-6 && left.depth_m == 2.0);
//! # Ok::<(), shutter_range::ParameterError>(())
//! ```

mod checked;
mod exposure;
mod flicker;
mod swing;
mod texture;
mod random;
mod contour;
mod shading;
mod view;
mod bar;
mod scene;
mod blur;
mod layer;
mod noise;
mod row_texture;
mod tint;
mod encoding;
mod simulator;
mod truth;
mod tone_curve;
mod window;
mod neighbours;
mod stage;
mod pipeline;

pub use bar::Bar;
pub use contour::Contour;
pub use exposure::Exposure;
pub use flicker::Flicker;
pub use pipeline::Pipeline;
pub use scene::{Background, Object, Rail, Scene};
pub use shading::Shading;
pub use simulator::Simulator;
pub use stage::Stage;
pub use swing::Swing;
pub use texture::Texture;
pub use tint::Tint;
pub use tone_curve::ToneCurve;
pub use truth::Truth;
