//! [`Observation`]: a sample as a ray in the axes of the frame-start camera. docs/model.md, section 3.

use super::sample::Sample;
use crate::motion::{Motion, RotationMatrix};
use crate::scalar::{Arithmetic, Near, Scalar, dot, near_add, near_cross, near_dot, over, scale, size_of_all};
use crate::setup::{Camera, RaySpan, RaySpans};

/// A normal `n` of the plane through a ray and a direction, as far as a line through the plane y = 0 needs it.
#[derive(Clone, Copy)]
pub(crate) struct Normal<N> {
    pub(crate) x: N,
    pub(crate) z: N,
    /// n · p, with p where the ray starts.
    pub(crate) moved: N,
}

impl<N: Near> Normal<N> {
    fn of(ray: [N; 3], direction: [N; 3], position: [N; 3]) -> Self {
        let normal = near_cross(ray, direction);
        let [x, _, z] = normal;
        Self { x, z, moved: near_dot(normal, position) }
    }

    /// Of a direction in the image plane.
    fn of_flat([x, y, z]: [N; 3], [ex, ey, _]: [N; 3], position: [N; 3]) -> Self {
        let normal = [-z.times(ey), z.times(ex), x.times(ey).minus_product(y, ex)];
        let [x, _, z] = normal;
        Self { x, z, moved: near_dot(normal, position) }
    }

    /// Of the direction down in the axes of a level camera.
    fn of_down([x, _, z]: [N; 3], [px, _, pz]: [N; 3]) -> Self {
        Self { x: -z, z: x, moved: x.times(pz).minus_product(z, px) }
    }

    /// Of the direction to the right, in which edges lean before a level camera.
    fn of_lean([_, y, z]: [N; 3], [_, py, pz]: [N; 3]) -> Self {
        Self { x: N::ZERO, z: -y, moved: z.times(py).minus_product(y, pz) }
    }

    /// That of a ray along the x axis and down, in the axes of a level camera.
    fn of_level_right(x: N, [_, _, pz]: [N; 3]) -> Self {
        Self { x: N::ZERO, z: x, moved: x.times(pz) }
    }

    /// Of a direction along the x axis.
    fn of_right(x: N, [_, ey, ez]: [N; 3], [_, py, pz]: [N; 3]) -> Self {
        let z = x.times(ey);
        Self { x: N::ZERO, z, moved: z.times(pz).minus_product(x.times(ez), py) }
    }

    /// That of two parallel directions.
    const NOTHING: Self = Self { x: N::ZERO, z: N::ZERO, moved: N::ZERO };

    fn minus_twice(self) -> Self {
        Self { x: -(self.x + self.x), z: -(self.z + self.z), moved: -(self.moved + self.moved) }
    }

    fn with_reach(self, more: i32) -> Self {
        Self { moved: self.moved.over_power_of_two(more), ..self }
    }
}

/// A camera turns by no more than twice this angle, in radians, while a ray sweeps along: what the second order leaves
/// out is a hundredth of the path then, and numbers near one have room for it (`cargo test a_turn_within_the_exposure`).
const MOST_HALF_TURN: (i32, i32) = (1, 4);

/// A ray against the two directions that an edge is made of. In size their numbers are at most √3.
#[derive(Clone, Copy)]
pub(crate) struct Normals<S: Scalar> {
    /// d × g: m of an upright edge.
    pub(crate) down: Normal<S::Near>,
    /// d × e: what a unit of tilt adds.
    pub(crate) lean: Normal<S::Near>,
    /// Their changes by a pixel along the row.
    pub(crate) down_per_px: Normal<S::Near>,
    pub(crate) lean_per_px: Normal<S::Near>,
    pub(crate) units: Units,
    /// False once the robust fit has rejected the observation. Here there is a byte of room beside the units.
    pub(crate) is_inlier: bool,
}

/// Exponents of the powers of two that [`Normals`] are in units of.
// Bytes: there is one of them for each knot.
#[derive(Clone, Copy)]
pub(crate) struct Units {
    ray: i8,
    per_px: i8,
    reach: i8,
}

impl Units {
    fn new<N: Near>(ray: i32, per_px: i32, reach: i32) -> Self {
        if N::IS_WIDE {
            return Self { ray: 0, per_px: 0, reach: 0 };
        }
        // Only that of nothing is beyond.
        let [ray, per_px, reach] = [ray, per_px, reach].map(|exponent| exponent.clamp(-127, 127) as i8);
        Self { ray, per_px, reach }
    }

    /// Of all.
    pub(super) fn ray(self) -> i32 {
        self.ray.into()
    }

    /// Of a pixel along the row.
    pub(super) fn per_px(self) -> i32 {
        self.per_px.into()
    }

    /// Of the position, in metres.
    pub(super) fn reach(self) -> i32 {
        self.reach.into()
    }
}

impl<S: Scalar> Normals<S> {
    /// With a unit of the position that is no smaller.
    pub(super) fn with_reach(&self, reach: i32) -> Self {
        let more = reach - self.units.reach();
        let [down, lean, down_per_px, lean_per_px] =
            [self.down, self.lean, self.down_per_px, self.lean_per_px].map(|normal| normal.with_reach(more));
        Self {
            down,
            lean,
            down_per_px,
            lean_per_px,
            units: Units::new::<S::Near>(self.units.ray(), self.units.per_px(), reach),
            is_inlier: self.is_inlier,
        }
    }
}

/// A sample as a ray, and its noise.
#[derive(Clone, Copy)]
pub(crate) struct Observation<S: Scalar> {
    pub(crate) normals: Normals<S>,
    /// Bearings to the right and downwards in the camera's axes at that time, in the unit of the ray.
    pub(super) near_bearings: [S::Near; 2],
    time_s: S::Kept,
    rows: S::Kept,
    sigma_px: S::Kept,
    per_sigma: S::Kept,
}

/// Directions of the rays at the ends of a span, as their mean and half their difference, the middle position and half
/// the difference of the positions at the ends.
struct Rays<N> {
    direction: [N; 3],
    half: [N; 3],
    along_row: [N; 3],
    position: [N; 3],
    half_position: [N; 3],
    units: Units,
}

/// From sample to observation, one after the other along a line.
pub(crate) struct Observer<'a, S: Scalar, M> {
    spans: RaySpans<'a, S>,
    motion: &'a M,
    /// Those of the line that the observations are held against.
    gravity: [S::Near; 3],
    lean: [S::Near; 3],
    /// Whether these are the axes of the camera at frame start: next to nothing is left of their products then.
    is_level: bool,
    /// What the motion is, where that is constant.
    steady: Option<ConstantRates<S::Near>>,
    /// Rounding of the columns of the image.
    least_sigma_px: S,
}

impl<'a, S: Scalar, M: Motion<S>> Observer<'a, S, M> {
    pub(crate) fn new(camera: &'a Camera<S>, motion: &'a M, directions: [[S; 3]; 2]) -> Self {
        // Unit vectors.
        let is_level = directions == [[S::ZERO, S::ONE, S::ZERO], [S::ONE, S::ZERO, S::ZERO]];
        let [gravity, lean] = directions.map(|direction| direction.map(|component| component.near(0)));
        let steady = motion.constant_rates().map(ConstantRates::new);
        let least_sigma_px = S::from_i32(i32::from(camera.intrinsics().columns) + 1) * (S::EPSILON + S::EPSILON);
        Self { spans: RaySpans::new(camera), motion, gravity, lean, is_level, steady, least_sigma_px }
    }

    /// `None` where the lens model has no ray.
    pub(crate) fn observe(&mut self, sample: &Sample<S>) -> Option<Observation<S>> {
        let spread = &sample.spread;
        let (at, half) = ([sample.column_px, sample.row_px], [spread.column_px, spread.row_px]);
        let span = self.spans.span(at, half);
        self.observe_span(sample, span.as_ref())
    }

    // Not inlined: what a lens needs has left the stack before.
    #[inline(never)]
    fn observe_span(&self, sample: &Sample<S>, span: Option<&RaySpan<S::Near>>) -> Option<Observation<S>> {
        let (span, spread) = (span?, &sample.spread);
        let rays = self.rays(span, sample.time_s, spread.time_s);
        let mut normals = self.normals(&rays);
        // Up to the third order, the mean over a span is that of two points one standard deviation off its middle, and
        // that of a product the product of the means and this. What it would add to the lean is the product of two
        // small numbers.
        normals.down.moved = normals.down.moved + self.down(rays.half, rays.half_position).moved;
        let sigma_px = sample.sigma_px.max(self.least_sigma_px);
        Some(Observation {
            normals,
            near_bearings: span.middle,
            time_s: sample.time_s.kept(),
            // n rows have a variance of n²/12.
            rows: (spread.row_px * S::ratio(34_641_016, 10_000_000)).max(S::ONE).kept(),
            sigma_px: sigma_px.kept(),
            per_sigma: over(sigma_px).kept(),
        })
    }

    /// What the ray of a point at the start of a time differs by from that at its end; `None` where the camera turns by
    /// more than a small angle meanwhile, which is reckoned to the second order.
    pub(super) fn sweep(&mut self, point: &Sample<S>, half_s: S) -> Option<Normals<S>> {
        if M::MAY_TURN && !self.motion.keeps_attitude() {
            let half_turn = scale(self.motion.pose(point.time_s).rate_rad_s, half_s);
            let most = S::ratio(MOST_HALF_TURN.0, MOST_HALF_TURN.1);
            if !(dot(half_turn, half_turn) <= most * most) {
                return None;
            }
        }
        let span = self.spans.span([point.column_px, point.row_px], [S::ZERO; 2])?;
        let rays = self.rays(&span, point.time_s, half_s);
        let Rays { direction, half, position, half_position, .. } = rays;
        let (mut down, mut lean) = (self.down(half, position), self.lean(half, position));
        down.moved = down.moved + self.down(direction, half_position).moved;
        lean.moved = lean.moved + self.lean(direction, half_position).moved;
        Some(Normals { down: down.minus_twice(), lean: lean.minus_twice(), ..self.normals(&rays) })
    }

    /// That of a ray and gravity.
    fn down(&self, ray: [S::Near; 3], position: [S::Near; 3]) -> Normal<S::Near> {
        if self.is_level { Normal::of_down(ray, position) } else { Normal::of(ray, self.gravity, position) }
    }

    /// That of a ray and the lean.
    fn lean(&self, ray: [S::Near; 3], position: [S::Near; 3]) -> Normal<S::Near> {
        if self.is_level { Normal::of_lean(ray, position) } else { Normal::of_flat(ray, self.lean, position) }
    }

    /// Those through a ray and the two directions that an edge is made of.
    fn normals(&self, rays: &Rays<S::Near>) -> Normals<S> {
        let Rays { direction, along_row, position, units, .. } = *rays;
        let (down, lean) = (|ray| self.down(ray, position), |ray| self.lean(ray, position));
        let none = S::Near::ZERO;
        let [down_per_px, lean_per_px] = match along_row {
            // Neither the camera has turned nor the lens distorts.
            [right, y, z] if y == none && z == none => {
                if self.is_level {
                    [Normal::of_level_right(right, position), Normal::NOTHING]
                } else {
                    [self.gravity, self.lean].map(|axis| Normal::of_right(right, axis, position))
                }
            }
            _ => [down(along_row), lean(along_row)],
        };
        Normals { down: down(direction), lean: lean(direction), down_per_px, lean_per_px, units, is_inlier: true }
    }

    /// The rays in the axes of frame start, where they look and where from.
    #[inline(never)]
    fn rays(&self, span: &RaySpan<S::Near>, time_s: S, half_s: S) -> Rays<S::Near> {
        let &RaySpan { middle: [u, w], half: [half_u, half_w], along_row: [du, dw], ray, along } = span;
        let passage = self.passage(time_s, half_s);
        let Passage { position, half_position, angle, reach, .. } = passage;
        let units = Units::new::<S::Near>(ray, along - ray, reach);
        let (one, none) = (S::Near::ratio(1, 1).over_power_of_two(ray), S::Near::ZERO);
        let Some(rotation) = passage.rotation.filter(|_| M::MAY_TURN) else {
            let (direction, half, along_row) = ([u, w, one], [half_u, half_w, none], [du, dw, none]);
            return Rays { direction, half, along_row, position, half_position, units };
        };
        let (ahead, across) = (rotation.ahead(one), rotation.across([u, w]));
        let is_straight = dw == none;
        let along_row = if is_straight { rotation.right(du) } else { rotation.across([du, dw]) };
        let half = rotation.across([half_u, half_w]);
        // By half of the span the camera turns on: exp(±θ) (d ± h), to the second order.
        let turned = near_cross(angle, near_add(ahead, across));
        // The smallest first: single precision has no digit to spare.
        let turned_twice = near_cross(angle, near_add(half, turned.map(Arithmetic::half)));
        let direction = near_add(ahead, near_add(across, turned_twice));
        Rays { direction, half: near_add(half, turned), along_row, position, half_position, units }
    }

    /// Where the camera is at a time, and what it does in `half_s`.
    fn passage(&self, time_s: S, half_s: S) -> Passage<S::Near> {
        if let Some(passage) = self.steady.as_ref().and_then(|rates| rates.passage::<S, M>(time_s, half_s)) {
            return passage;
        }
        self.passage_by_pose(time_s, half_s)
    }

    #[inline(never)]
    fn passage_by_pose(&self, time_s: S, half_s: S) -> Passage<S::Near> {
        let pose = self.motion.pose(time_s);
        let (position, half_position) = (pose.position_m, scale(pose.velocity_m_s, half_s));
        let reach = size_of_all(position).max(size_of_all(half_position)) + 1;
        let [position, half_position] = [position, half_position].map(|path| path.map(|part| part.near(reach)));
        let angle = scale(pose.rate_rad_s, half_s).map(|part| part.near(0));
        let rotation = RotationMatrix(pose.rotation.map(|row| row.map(|part| part.near(0))));
        let rotation = (M::MAY_TURN && !self.motion.keeps_attitude()).then_some(rotation);
        Passage { position, half_position, rotation, angle, reach }
    }
}

/// Where a camera is, and by how much it goes on within half a span.
struct Passage<N> {
    position: [N; 3],
    half_position: [N; 3],
    /// `None` where it keeps its attitude.
    rotation: Option<RotationMatrix<N>>,
    angle: [N; 3],
    reach: i32,
}

/// Constant velocity and rotation rate, near one, with the exponents of their units.
struct ConstantRates<N> {
    velocity: [N; 3],
    speed: i32,
    /// `None` where the camera keeps its attitude.
    rate: Option<[N; 3]>,
    turn: i32,
}

impl<N: Near> ConstantRates<N> {
    fn new<S: Scalar<Near = N>>([velocity, rate]: [[S; 3]; 2]) -> Self {
        let (speed, turn) = (size_of_all(velocity) + 1, size_of_all(rate));
        let keeps_attitude = rate == [S::ZERO; 3];
        let rate = (!keeps_attitude).then(|| rate.map(|part| part.near(turn)));
        Self { velocity: velocity.map(|part| part.near(speed)), speed, rate, turn }
    }

    /// `None` where the camera has turned by more than a small angle.
    fn passage<S: Scalar<Near = N>, M: Motion<S>>(&self, time_s: S, half_s: S) -> Option<Passage<N>> {
        let unit = size_of_all([time_s, half_s]);
        let (time, half) = (time_s.near(unit), half_s.near(unit));
        let over = -(self.turn + unit);
        let turned = |rate: [N; 3], time: N| rate.map(|part| part.times(time).over_power_of_two(over));
        let (rotation, angle) = match self.rate.filter(|_| M::MAY_TURN) {
            None => (None, [N::ZERO; 3]),
            Some(rate) if over >= 0 => (Some(RotationMatrix::of_small(turned(rate, time))?), turned(rate, half)),
            Some(_) => return None,
        };
        let [position, half_position] = [time, half].map(|time| self.velocity.map(|part| part.times(time)));
        Some(Passage { position, half_position, rotation, angle, reach: self.speed + unit })
    }
}

impl<S: Scalar> Observation<S> {
    /// Bearings to the right and downwards in the camera's axes at that time.
    pub(super) fn bearings(&self) -> [S; 2] {
        self.near_bearings.map(|part| S::of_near(part, self.normals.units.ray()))
    }

    pub(super) fn time_s(&self) -> S {
        S::of_kept(self.time_s)
    }

    /// Number of rows that it is the mean of, at least one.
    pub(super) fn rows(&self) -> S {
        S::of_kept(self.rows)
    }

    /// Stated noise.
    pub(crate) fn sigma_px(&self) -> S {
        S::of_kept(self.sigma_px)
    }

    /// One over the sigma that a fit takes it with: of its noise, or also of the edge.
    pub(super) fn per_sigma(&self) -> S {
        S::of_kept(self.per_sigma)
    }

    pub(super) fn set_per_sigma(&mut self, per_sigma: S) {
        self.per_sigma = per_sigma.kept();
    }
}

/// The plane of a row at its time: `y = slope · z` from where the camera is.
pub(crate) struct RowPlane<S> {
    pub(crate) slope: S,
    pub(crate) y: S,
    pub(crate) z: S,
}

impl<S: Scalar> RowPlane<S> {
    pub(crate) fn new<M: Motion<S>>(motion: &M, observation: &Observation<S>) -> Self {
        let pose = motion.pose(observation.time_s());
        let [u, w] = observation.bearings();
        let ([_, dy, dz], [_, y, z]) = (pose.rotate([u, w, S::ONE]), pose.position_m);
        Self { slope: dy / dz, y, z }
    }
}
