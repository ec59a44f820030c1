//! [`Motion`]: where the camera is at any time of the frame, and where down is.

use crate::vector::{add, cross, dot, scale};
use crate::{ParameterError, Scalar};

/// Position, attitude and their changes at one time, in the axes of the frame-start camera.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Pose<S> {
    /// Position since frame start in metres.
    pub position_m: [S; 3],
    /// Rotation from the camera's axes now to those at frame start, row by row.
    pub rotation: [[S; 3]; 3],
    /// Velocity in metres per second.
    pub velocity_m_s: [S; 3],
    /// Rotation rate in radians per second.
    pub rate_rad_s: [S; 3],
}

impl<S: Scalar> Pose<S> {
    /// Frame start itself, at rest.
    pub(crate) const START: Self = Self {
        position_m: [S::ZERO; 3],
        rotation: [[S::ONE, S::ZERO, S::ZERO], [S::ZERO, S::ONE, S::ZERO], [S::ZERO, S::ZERO, S::ONE]],
        velocity_m_s: [S::ZERO; 3],
        rate_rad_s: [S::ZERO; 3],
    };

    /// A direction of the camera's axes, turned into those of the frame-start camera.
    #[must_use]
    pub fn turn(&self, direction: [S; 3]) -> [S; 3] {
        self.rotation.map(|row| dot(row, direction))
    }

    /// Position and attitude after moving on at a constant velocity and rotation rate *in the camera's axes*: on an arc.
    pub(crate) fn moved(self, velocity_m_s: [S; 3], rate_rad_s: [S; 3], time_s: S) -> Self {
        let turn = Turn::by(scale(rate_rad_s, time_s));
        let way = self.turn(turn.arc(scale(velocity_m_s, time_s)));
        let [first, second, third] = turn.rotation();
        let rotation = self.rotation.map(|[x, y, z]| add(add(scale(first, x), scale(second, y)), scale(third, z)));
        Self { position_m: add(self.position_m, way), rotation, ..self }
    }
}

/// A camera's motion during one frame.
///
/// [`Twist`] is the usual one, [`Trajectory`](crate::Trajectory) makes one of what sensors deliver; implement the trait
/// for anything else. At time zero the position must be zero and the rotation none.
pub trait Motion<S> {
    /// Pose `time_s` seconds after frame start. Called once per knot of a line.
    fn pose(&self, time_s: S) -> Pose<S>;

    /// Unit vector "down" in the axes of the frame-start camera; `[0, 1, 0]` for a level one.
    fn gravity(&self) -> [S; 3];
}

/// Constant velocity and constant rotation rate.
///
/// For a camera that stands still before an object that moves, give the opposite of the object's velocity.
///
/// ```
/// use shutter_range::{Motion, Twist};
/// // To the right at 1.5 m/s, turning left at 0.1 rad/s, level.
/// let motion = Twist::new([1.5, 0.0, 0.0], [0.0, -0.1, 0.0], [0.0, 1.0, 0.0])?;
/// assert_eq!(motion.pose(0.01).position_m, [0.015, 0.0, 0.0]);
/// # Ok::<(), shutter_range::ParameterError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "RawTwist<S>"))]
#[cfg_attr(feature = "serde", serde(bound(deserialize = "S: Scalar + serde::Deserialize<'de>")))]
pub struct Twist<S> {
    velocity_m_s: [S; 3],
    rate_rad_s: [S; 3],
    gravity: [S; 3],
}

/// Faster than anything that carries a camera, and far from overflow in fixed point.
const MAX_SPEED_M_S: i32 = 10_000;
const MAX_RATE_RAD_S: i32 = 1_000;

impl<S: Scalar> Twist<S> {
    /// From the camera's velocity (m/s) and rotation rate (rad/s, right-handed: positive about y turns right, about x
    /// looks up, about z rolls the camera clockwise) in its own axes at frame start, and the direction of gravity there,
    /// of any length: an accelerometer at rest shows its opposite.
    ///
    /// *Errors*: a component that is not finite or beyond 10000 m/s and 1000 rad/s; a gravity without direction.
    pub fn new(velocity_m_s: [S; 3], rate_rad_s: [S; 3], gravity: [S; 3]) -> Result<Self, ParameterError> {
        Ok(Self {
            velocity_m_s: checked_velocity(velocity_m_s)?,
            rate_rad_s: checked_rate(rate_rad_s)?,
            gravity: checked_direction(gravity)?,
        })
    }

    /// A level camera that moves without turning.
    ///
    /// *Errors*: as [`Twist::new`].
    pub fn level(velocity_m_s: [S; 3]) -> Result<Self, ParameterError> {
        Self::new(velocity_m_s, [S::ZERO; 3], [S::ZERO, S::ONE, S::ZERO])
    }

    /// Velocity in m/s.
    #[must_use]
    pub const fn velocity_m_s(&self) -> [S; 3] {
        self.velocity_m_s
    }

    /// Rotation rate in rad/s.
    #[must_use]
    pub const fn rate_rad_s(&self) -> [S; 3] {
        self.rate_rad_s
    }
}

pub(crate) fn checked_velocity<S: Scalar>(velocity_m_s: [S; 3]) -> Result<[S; 3], ParameterError> {
    check("velocity_m_s", velocity_m_s, MAX_SPEED_M_S, "finite, at most 10000 (m/s)")?;
    Ok(velocity_m_s)
}

pub(crate) fn checked_rate<S: Scalar>(rate_rad_s: [S; 3]) -> Result<[S; 3], ParameterError> {
    check("rate_rad_s", rate_rad_s, MAX_RATE_RAD_S, "finite, at most 1000 (rad/s)")?;
    Ok(rate_rad_s)
}

/// As a unit vector.
pub(crate) fn checked_direction<S: Scalar>(gravity: [S; 3]) -> Result<[S; 3], ParameterError> {
    check("gravity", gravity, 1_000, "finite, at most 1000 (only its direction counts)")?;
    let length = dot(gravity, gravity).sqrt();
    if !(length >= S::ratio(1, 1_000)) {
        return Err(ParameterError::new("gravity", length.to_f64(), "a direction: at least 0.001 long"));
    }
    Ok(gravity.map(|component| component / length))
}

fn check<S: Scalar>(
    name: &'static str,
    vector: [S; 3],
    limit: i32,
    expected: &'static str,
) -> Result<(), ParameterError> {
    match vector.into_iter().find(|c| !(c.is_finite() && c.abs() <= S::from_i32(limit))) {
        Some(component) => Err(ParameterError::new(name, component.to_f64(), expected)),
        None => Ok(()),
    }
}

impl<S: Scalar> Motion<S> for Twist<S> {
    fn pose(&self, time_s: S) -> Pose<S> {
        Pose {
            position_m: scale(self.velocity_m_s, time_s),
            rotation: Turn::by(scale(self.rate_rad_s, time_s)).rotation(),
            velocity_m_s: self.velocity_m_s,
            rate_rad_s: self.rate_rad_s,
        }
    }

    fn gravity(&self) -> [S; 3] {
        self.gravity
    }
}

/// A turn at a constant rate: its rotation vector φ with `sin φ / φ`, `(1 − cos φ) / φ²` and `(φ − sin φ) / φ³`.
struct Turn<S> {
    vector: [S; 3],
    a: S,
    b: S,
    c: S,
}

impl<S: Scalar> Turn<S> {
    /// The angles of a frame are small, so a short series does, without trigonometry of the back end; its error is below
    /// 10⁻¹² up to one radian.
    fn by(vector: [S; 3]) -> Self {
        let square = dot(vector, vector);
        if square > S::ONE {
            let angle = square.sqrt();
            let a = angle.sin() / angle;
            return Self { vector, a, b: (S::ONE - angle.cos()) / square, c: (S::ONE - a) / square };
        }
        let (mut a, mut b, mut c) = (S::ONE, S::ONE, S::ONE);
        for k in (1..=7).rev() {
            c = a;
            a = S::ONE - a * square * S::ratio(1, 2 * k * (2 * k + 1));
            b = S::ONE - b * square * S::ratio(1, (2 * k + 1) * (2 * k + 2));
        }
        Self { vector, a, b: b * S::ratio(1, 2), c: c * S::ratio(1, 6) }
    }

    /// Its rotation matrix (Rodrigues): `v + A φ×v + B φ×(φ×v)`.
    fn rotation(&self) -> [[S; 3]; 3] {
        let column = |axis| self.bend(axis, self.a, self.b);
        let [xx, yx, zx] = column([S::ONE, S::ZERO, S::ZERO]);
        let [xy, yy, zy] = column([S::ZERO, S::ONE, S::ZERO]);
        let [xz, yz, zz] = column([S::ZERO, S::ZERO, S::ONE]);
        [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]]
    }

    /// Where one gets to who goes `way`, always straight ahead, while turning: `v + B φ×v + C φ×(φ×v)`.
    fn arc(&self, way: [S; 3]) -> [S; 3] {
        self.bend(way, self.b, self.c)
    }

    fn bend(&self, v: [S; 3], once: S, twice: S) -> [S; 3] {
        let across = cross(self.vector, v);
        add(add(v, scale(across, once)), scale(cross(self.vector, across), twice))
    }
}

#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct RawTwist<S> {
    velocity_m_s: [S; 3],
    rate_rad_s: [S; 3],
    gravity: [S; 3],
}

#[cfg(feature = "serde")]
impl<S: Scalar> TryFrom<RawTwist<S>> for Twist<S> {
    type Error = ParameterError;

    fn try_from(raw: RawTwist<S>) -> Result<Self, ParameterError> {
        Self::new(raw.velocity_m_s, raw.rate_rad_s, raw.gravity)
    }
}
