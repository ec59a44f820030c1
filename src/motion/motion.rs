//! [`Motion`]: where the camera is at any time of the frame, and which way is down.

use super::rotation::Rotation;
use crate::scalar::{Scalar, add, dot, scale};

/// Position, attitude and their rates at one time, in the axes of the frame-start camera.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Pose<S> {
    /// Position in metres; zero at frame start.
    pub position_m: [S; 3],
    /// Rotation matrix from the camera's axes at this time to those at frame start, as rows.
    pub rotation: [[S; 3]; 3],
    /// Velocity in metres per second.
    pub velocity_m_s: [S; 3],
    /// Rotation rate in radians per second.
    pub rate_rad_s: [S; 3],
}

impl<S: Scalar> Pose<S> {
    /// The pose at frame start, at rest.
    pub(crate) const START: Self = Self {
        position_m: [S::ZERO; 3],
        rotation: [[S::ONE, S::ZERO, S::ZERO], [S::ZERO, S::ONE, S::ZERO], [S::ZERO, S::ZERO, S::ONE]],
        velocity_m_s: [S::ZERO; 3],
        rate_rad_s: [S::ZERO; 3],
    };

    /// Rotates a direction from the camera's axes at this time into those at frame start.
    #[must_use]
    pub fn rotate(&self, direction: [S; 3]) -> [S; 3] {
        let [x, y, z] = self.rotation;
        [dot(x, direction), dot(y, direction), dot(z, direction)]
    }

    /// Position and attitude after moving on for a time at a velocity and a rotation rate that are constant *in the
    /// camera's axes*: along an arc.
    pub(crate) fn moved(self, velocity_m_s: [S; 3], rate_rad_s: [S; 3], time_s: S) -> Self {
        let step = Rotation::from_vector(scale(rate_rad_s, time_s));
        let displacement = self.rotate(step.displacement(scale(velocity_m_s, time_s)));
        let [first, second, third] = step.matrix();
        let rotation = self.rotation.map(|[x, y, z]| add(add(scale(first, x), scale(second, y)), scale(third, z)));
        Self { position_m: add(self.position_m, displacement), rotation, ..self }
    }
}

/// A camera's motion during one frame.
///
/// [`Twist`](crate::Twist) is the usual one, and [`Trajectory`](crate::Trajectory) makes one from what sensors deliver;
/// implement the trait for anything else. At time zero the position must be zero and the rotation the identity.
pub trait Motion<S> {
    /// Whether the camera may turn within a frame. `false` where no motion of the type does: a program then does not
    /// hold what turns rays, and takes the rotation of each pose for the identity. `true` is always right.
    const MAY_TURN: bool = true;

    /// Pose `time_s` seconds after frame start. Called once for each knot of a line, whose
    /// rows are taken to pass at the velocity and the rate that are told there.
    fn pose(&self, time_s: S) -> Pose<S>;

    /// Whether the camera does not turn during the frame, so that each pose has the identity for its rotation: the
    /// solver then rotates nothing. `false` is always right.
    fn keeps_attitude(&self) -> bool {
        false
    }

    /// Velocity in the axes of the frame-start camera and rotation rate in the camera's where both are constant, so
    /// that a pose follows from the time alone: the solver then asks for fewer poses. `None` is always right.
    fn constant_rates(&self) -> Option<[[S; 3]; 2]> {
        None
    }

    /// Unit vector "down" in the axes of the frame-start camera; `[0, 1, 0]` for a level one.
    fn gravity(&self) -> [S; 3];
}
