//! Several frames of a camera on any path past edges that may lean and move: an independent projection in world axes
//! and double precision.

use rand::{Rng, SeedableRng, rngs::StdRng};
use rand_distr::StandardNormal;
use shutter_range::{EdgePoint, Motion, Polarity, Pose, Range, Ranger, Scalar, Sequence, Setup, Uncertainty};

use crate::projection::{Matrix, Scene, Vector, rotation, times, transposed};
use crate::scenes::q16;

/// An edge in the world, through a point and along a direction, both at time zero.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Post {
    pub(crate) foot: Vector,
    pub(crate) down: Vector,
    pub(crate) velocity_m_s: Vector,
    pub(crate) polarity: Polarity,
}

impl Post {
    /// Upright and at rest.
    pub(crate) fn at(x: f64, z: f64) -> Self {
        Self { foot: [x, 0.0, z], down: [0.0, 1.0, 0.0], velocity_m_s: [0.0; 3], polarity: Polarity::Rising }
    }

    /// Leaning in the image plane of a level camera that looks ahead.
    pub(crate) fn leaning(self, slope: f64) -> Self {
        Self { down: [slope, 1.0, 0.0], ..self }
    }

    pub(crate) fn moving(self, velocity_m_s: Vector) -> Self {
        Self { velocity_m_s, ..self }
    }
}

/// Where the camera is in the world, and how it is turned (camera to world).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub(crate) position_m: Vector,
    pub(crate) rotation: Matrix,
}

/// A path through the world: velocity, its change, and a constant rotation rate about an axis that stays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Path {
    pub(crate) velocity_m_s: Vector,
    pub(crate) acceleration_m_s2: Vector,
    pub(crate) rate_rad_s: Vector,
    /// Attitude at time zero, as a rotation vector.
    pub(crate) attitude: Vector,
}

impl Path {
    pub(crate) fn straight(velocity_m_s: Vector) -> Self {
        Self { velocity_m_s, acceleration_m_s2: [0.0; 3], rate_rad_s: [0.0; 3], attitude: [0.0; 3] }
    }

    pub(crate) fn place(&self, time_s: f64) -> Place {
        let position_m = std::array::from_fn(|axis| {
            self.velocity_m_s[axis] * time_s + self.acceleration_m_s2[axis] * time_s * time_s / 2.0
        });
        let turned = rotation(self.rate_rad_s.map(|rate| rate * time_s));
        Place { position_m, rotation: product(rotation(self.attitude), turned) }
    }

    pub(crate) fn velocity_at(&self, time_s: f64) -> Vector {
        std::array::from_fn(|axis| self.velocity_m_s[axis] + self.acceleration_m_s2[axis] * time_s)
    }
}

/// How what is known of the camera differs from the truth, in every frame alike.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Disturbance {
    /// Relative error.
    pub(crate) speed: f64,
    pub(crate) rate_rad_s: Vector,
    /// Change of the direction of gravity in the camera's axes, in radians: roll, nothing, pitch.
    pub(crate) gravity: Vector,
    /// Relative error.
    pub(crate) readout: f64,
    /// Relative error.
    pub(crate) focal: f64,
}

/// The path as it is known for one frame, in the axes of the camera at the frame's start.
pub(crate) struct Known {
    pub(crate) path: Path,
    pub(crate) start_s: f64,
    pub(crate) disturbance: Disturbance,
}

impl<S: Scalar> Motion<S> for Known {
    fn pose(&self, time_s: S) -> Pose<S> {
        let time_s = time_s.to_f64();
        let (start, now) = (self.path.place(self.start_s), self.path.place(self.start_s + time_s));
        let Disturbance { speed, rate_rad_s, .. } = self.disturbance;
        let back = transposed(start.rotation);
        let moved_m = std::array::from_fn(|axis| (now.position_m[axis] - start.position_m[axis]) * (1.0 + speed));
        let velocity = times(back, self.path.velocity_at(self.start_s + time_s));
        let turned = product(rotation(rate_rad_s.map(|rate| rate * time_s)), product(back, now.rotation));
        let rate = std::array::from_fn(|axis| self.path.rate_rad_s[axis] + rate_rad_s[axis]);
        Pose {
            position_m: times(back, moved_m).map(S::from_f64),
            rotation: turned.map(|row| row.map(S::from_f64)),
            velocity_m_s: velocity.map(|v| S::from_f64(v * (1.0 + speed))),
            rate_rad_s: Vector::map(rate, S::from_f64),
        }
    }

    fn gravity(&self) -> [S; 3] {
        let down = times(transposed(self.path.place(self.start_s).rotation), [0.0, 1.0, 0.0]);
        let known: Vector = std::array::from_fn(|axis| down[axis] + self.disturbance.gravity[axis]);
        let length = known.iter().map(|c| c * c).sum::<f64>().sqrt();
        known.map(|c| S::from_f64(c / length))
    }
}

/// Camera, path and interval of a sequence of frames.
#[derive(Clone, Debug)]
pub(crate) struct Journey {
    pub(crate) camera: Scene,
    pub(crate) path: Path,
    pub(crate) interval_s: f64,
    pub(crate) sigma_px: f64,
    /// Rows from one point of an edge to the next.
    pub(crate) row_step: usize,
}

/// Bearing and inverse depth of a post in the axes of a frame's start.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Truth {
    pub(crate) bearing: f64,
    pub(crate) inverse_depth_per_m: f64,
}

impl Journey {
    /// VGA, 600 px, 1/30 s of readout and as much of interval, moving left at 1.5 m/s, 0.05 px of noise.
    pub(crate) fn vga() -> Self {
        let camera = Scene::vga();
        let path = Path::straight(camera.velocity_m_s);
        Self { interval_s: camera.readout_s, camera, path, sigma_px: 0.05, row_step: 1 }
    }

    pub(crate) fn start_s(&self, frame: u32) -> f64 {
        f64::from(frame) * self.interval_s
    }

    /// The motion during a frame, but for a disturbance.
    pub(crate) fn known(&self, frame: u32, disturbance: Disturbance) -> Known {
        Known { path: self.path, start_s: self.start_s(frame), disturbance }
    }

    /// The same with a camera of another readout and focal length than is known.
    pub(crate) fn through(&self, disturbance: &Disturbance) -> Self {
        let camera = &self.camera;
        let readout_s = camera.readout_s / (1.0 + disturbance.readout);
        let focal_px = camera.focal_px / (1.0 + disturbance.focal);
        Self { camera: Scene { readout_s, focal_px, ..camera.clone() }, ..self.clone() }
    }

    /// Points with the times that a camera of the readout `known` states.
    pub(crate) fn stamped(known: &Scene, points: Vec<EdgePoint>) -> Vec<EdgePoint> {
        points
            .into_iter()
            .map(|point| EdgePoint { time_ns: (known.time_s(point.row) * 1e9).round() as i64, ..point })
            .collect()
    }

    /// A point of a post and its direction, in the camera's axes at a time.
    fn in_camera(&self, post: &Post, time_s: f64) -> (Vector, Vector) {
        let place = self.path.place(time_s);
        let back = transposed(place.rotation);
        let foot =
            std::array::from_fn(|axis| post.foot[axis] + post.velocity_m_s[axis] * time_s - place.position_m[axis]);
        (times(back, foot), times(back, post.down))
    }

    pub(crate) fn truth(&self, post: &Post, frame: u32) -> Truth {
        let (foot, down) = self.in_camera(post, self.start_s(frame));
        let along = -foot[1] / down[1];
        let [x, z] = [foot[0] + along * down[0], foot[2] + along * down[2]];
        Truth { bearing: x / z, inverse_depth_per_m: 1.0 / z }
    }

    /// Column at which a post crosses a row of a frame; `None` outside the image or behind the camera.
    pub(crate) fn column(&self, post: &Post, frame: u32, row: u16) -> Option<f64> {
        let camera = &self.camera;
        let (a, b) = self.in_camera(post, self.start_s(frame) + camera.time_s(row));
        let w = (f64::from(row) - camera.cy) / camera.focal_px;
        let along = (w * a[2] - a[1]) / (b[1] - w * b[2]);
        let depth = a[2] + along * b[2];
        let column = camera.cx + camera.focal_px * (a[0] + along * b[0]) / depth;
        (depth > 0.0 && (0.0..f64::from(camera.columns - 1)).contains(&column)).then_some(column)
    }

    /// The noisy points of a frame, row by row and each row from left to right.
    pub(crate) fn points(&self, posts: &[Post], frame: u32, random: &mut StdRng) -> Vec<EdgePoint> {
        let mut points = Vec::new();
        for row in (0..self.camera.rows).step_by(self.row_step) {
            let mut of_row: Vec<_> = posts
                .iter()
                .filter_map(|post| {
                    let noise: f64 = random.sample(StandardNormal);
                    let column = self.column(post, frame, row)? + noise * self.sigma_px;
                    let point = self.camera.point_at(row, column).with_polarity(post.polarity);
                    Some(point.with_sigma_q16(q16(self.sigma_px) as u32))
                })
                .collect();
            of_row.sort_by_key(|point| point.column_q16);
            points.extend(of_row);
        }
        points
    }

    pub(crate) fn setup<S: Scalar>(&self, uncertainty: Uncertainty<S>) -> Setup<S> {
        self.camera.setup_with(uncertainty)
    }
}

pub(crate) type SequenceRanger = Ranger<16, 16, 32>;

/// A sequence under way, and what it is told of setup and motion.
pub(crate) struct Drive<S: Scalar, M: Fn(u32) -> Known> {
    pub(crate) setup: Setup<S>,
    /// The motion during each frame, as far as it is known.
    pub(crate) motion: M,
    pub(crate) interval_s: f64,
    pub(crate) ranger: SequenceRanger,
    pub(crate) sequence: Sequence<S, 16>,
    pub(crate) frame: u32,
}

impl<S: Scalar, M: Fn(u32) -> Known> Drive<S, M> {
    pub(crate) fn new(setup: Setup<S>, interval_s: f64, motion: M) -> Self {
        Self { setup, motion, interval_s, ranger: Ranger::new(), sequence: Sequence::new(), frame: 0 }
    }

    /// The ranges of the next frame, from left to right.
    pub(crate) fn frame(&mut self, points: &[EdgePoint]) -> Vec<Range<S>> {
        for point in points {
            self.ranger.edge_point(&self.setup, *point).expect("sound points");
        }
        self.ranger.end_frame(&self.setup);
        let motion = (self.motion)(self.frame);
        let mut ranges = Vec::new();
        self.sequence.frame(&self.setup, &motion, &mut self.ranger, |range| ranges.push(range));
        ranges.sort_by(|a, b| a.estimate.bearing.to_f64().total_cmp(&b.estimate.bearing.to_f64()));
        let interval_s = S::from_f64(self.interval_s);
        self.frame += 1;
        let gravity = Motion::<S>::gravity(&(self.motion)(self.frame));
        self.sequence.advance(&self.setup, &motion.pose(interval_s), interval_s, gravity).expect("sound gravity");
        ranges
    }
}

fn product(a: Matrix, b: Matrix) -> Matrix {
    let columns = transposed(b);
    a.map(|row| std::array::from_fn(|column| (0..3).map(|k| row[k] * columns[column][k]).sum()))
}

pub(crate) fn seed(number: u64) -> StdRng {
    StdRng::seed_from_u64(number)
}

pub(crate) fn normal(random: &mut StdRng) -> f64 {
    random.sample(StandardNormal)
}

/// Error of the inverse depth: relative, and in units of the stated sigma.
pub(crate) fn errors<S: Scalar>(range: &Range<S>, truth: &Truth) -> (f64, f64) {
    let error = range.estimate.inverse_depth_per_m.to_f64() - truth.inverse_depth_per_m;
    (error / truth.inverse_depth_per_m, error / range.estimate.sigma_inverse_depth_per_m.to_f64())
}

/// The range of a single post with its errors, frame by frame.
pub(crate) fn follow<S: Scalar>(
    journey: &Journey,
    disturbance: Disturbance,
    uncertainty: Uncertainty<S>,
    post: &Post,
    frames: u32,
    random: &mut StdRng,
) -> Vec<(Range<S>, f64, f64)> {
    let real = journey.through(&disturbance);
    let known = |frame| journey.known(frame, disturbance);
    let mut drive = Drive::new(journey.setup(uncertainty), journey.interval_s, known);
    let mut result = Vec::new();
    for frame in 0..frames {
        let points = Journey::stamped(&journey.camera, real.points(&[*post], frame, random));
        let ranges = drive.frame(&points);
        let [range] = ranges.as_slice() else { panic!("frame {frame}: {ranges:#?}") };
        let (relative, normal) = errors(range, &real.truth(post, frame));
        result.push((*range, relative, normal));
    }
    result
}
