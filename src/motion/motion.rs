//! [`Motion`]: where the camera is at any time of the frame, and where down is.

use super::turn::Turn;
use crate::scalar::{Scalar, add, dot, scale};

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
/// [`Twist`](crate::Twist) is the usual one, [`Trajectory`](crate::Trajectory) makes one of what sensors deliver; implement the trait
/// for anything else. At time zero the position must be zero and the rotation none.
pub trait Motion<S> {
    /// Pose `time_s` seconds after frame start. Called once per knot of a line.
    fn pose(&self, time_s: S) -> Pose<S>;

    /// Unit vector "down" in the axes of the frame-start camera; `[0, 1, 0]` for a level one.
    fn gravity(&self) -> [S; 3];
}
