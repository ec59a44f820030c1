//! [`Motion`]: where the camera is at any time of the frame, and where down is.

use crate::vector::{cross, dot, scale};
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
    /// A direction of the camera's axes, turned into those of the frame-start camera.
    #[must_use]
    pub fn turn(&self, direction: [S; 3]) -> [S; 3] {
        self.rotation.map(|row| dot(row, direction))
    }
}

/// A camera's motion during one frame.
///
/// [`Twist`] is the usual one; implement the trait for measured trajectories. At time zero the position must be zero
/// and the rotation none.
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
        check("velocity_m_s", velocity_m_s, MAX_SPEED_M_S, "finite, at most 10000 (m/s)")?;
        check("rate_rad_s", rate_rad_s, MAX_RATE_RAD_S, "finite, at most 1000 (rad/s)")?;
        check("gravity", gravity, 1_000, "finite, at most 1000 (only its direction counts)")?;
        let length = dot(gravity, gravity).sqrt();
        if !(length >= S::ratio(1, 1_000)) {
            return Err(ParameterError::new("gravity", length.to_f64(), "a direction: at least 0.001 long"));
        }
        Ok(Self { velocity_m_s, rate_rad_s, gravity: gravity.map(|component| component / length) })
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
            rotation: rotation(scale(self.rate_rad_s, time_s)),
            velocity_m_s: self.velocity_m_s,
            rate_rad_s: self.rate_rad_s,
        }
    }

    fn gravity(&self) -> [S; 3] {
        self.gravity
    }
}

/// Rotation matrix of a rotation vector (Rodrigues): `v + A φ×v + B φ×(φ×v)`.
fn rotation<S: Scalar>(vector: [S; 3]) -> [[S; 3]; 3] {
    let (a, b) = rodrigues(dot(vector, vector));
    let column = |axis: [S; 3]| {
        let once = cross(vector, axis);
        let twice = cross(vector, once);
        let [x, y, z] = axis;
        let [ox, oy, oz] = scale(once, a);
        let [tx, ty, tz] = scale(twice, b);
        [x + ox + tx, y + oy + ty, z + oz + tz]
    };
    let [xx, yx, zx] = column([S::ONE, S::ZERO, S::ZERO]);
    let [xy, yy, zy] = column([S::ZERO, S::ONE, S::ZERO]);
    let [xz, yz, zz] = column([S::ZERO, S::ZERO, S::ONE]);
    [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]]
}

/// `sin φ / φ` and `(1 − cos φ) / φ²` from φ². The angles of a frame are small, so a short series does, without
/// trigonometry of the back end; its error is below 10⁻¹² up to one radian.
fn rodrigues<S: Scalar>(square: S) -> (S, S) {
    if square > S::ONE {
        let angle = square.sqrt();
        return (angle.sin() / angle, (S::ONE - angle.cos()) / square);
    }
    let (mut a, mut b) = (S::ONE, S::ONE);
    for k in (1..=7).rev() {
        a = S::ONE - a * square * S::ratio(1, 2 * k * (2 * k + 1));
        b = S::ONE - b * square * S::ratio(1, (2 * k + 1) * (2 * k + 2));
    }
    (a, b * S::ratio(1, 2))
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
