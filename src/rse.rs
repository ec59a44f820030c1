//! The paper's equations (1)–(14) in closed form, and the exact range from two endpoints.
//!
//! Equations (3), (10) and (13) are one equation, and with a signed tangent of α it keeps the side that the paper's
//! absolute value loses:
//!
//! ```text
//! tan θ = κ · s · v / h · (cos ω + sin ω · tan α),      κ = c/(n p) = f/n
//! ```
//!
//! θ is the angle of the edge in the image, s the readout time of the whole frame (the paper's "shutter speed"), v the
//! speed of the object, h its depth (the "vertical distance"), ω the heading of its motion relative to the image plane:
//! an *object* that moves by (v cos ω, −v sin ω) in (x, z). A camera that moves right and forward has ω between 90° and
//! 180°.
//!
//! These are first-order: use [`fit`](crate::fit()) for rotation, attitude and anything measured on more than two rows.

use crate::error::ParameterError;
use crate::range::{Budget, Estimate};
use crate::scalar::{Scalar, hypot};

/// κ of the paper's camera: one constant that explains its field test. Calibrated from the published figures, since the
/// paper's own table of parameters does not give it (sensor height: 2.26; 16:9 crop: 2.69; 3840 rows: 2.3616).
pub const PAPER_KAPPA: f64 = 2.361;

/// κ = c/(n p) from the focal length c in mm, the number of rows n and the pixel pitch p in µm. *Source*: eq. (3).
#[must_use]
pub fn kappa<S: Scalar>(focal_length_mm: S, rows: S, pixel_pitch_um: S) -> S {
    focal_length_mm / pixel_pitch_um * S::from_i32(1000) / rows
}

/// y2 = y1 + n Δt/s: the row that is read `elapsed_s` after row `y1`. *Source*: eq. (1).
#[must_use]
pub fn row_after<S: Scalar>(y1: S, rows: S, frame_readout_s: S, elapsed_s: S) -> S {
    y1 + rows * (elapsed_s / frame_readout_s)
}

/// x2 = x1 + f · shift/h: the column after a sideways shift (m) at depth h (m). *Source*: eqs. (2) and (8).
#[must_use]
pub fn column_after<S: Scalar>(x1: S, focal_px: S, sideways_m: S, depth_m: S) -> S {
    x1 + focal_px * (sideways_m / depth_m)
}

/// d = h/cos α from the tangent of α. *Source*: eq. (5).
#[must_use]
pub fn distance_m<S: Scalar>(depth_m: S, bearing: S) -> S {
    depth_m * (S::ONE + bearing * bearing).sqrt()
}

/// tan α = (x − p_x)/f, signed. *Source*: eq. (6).
#[must_use]
pub fn bearing<S: Scalar>(column: S, principal_column: S, focal_px: S) -> S {
    (column - principal_column) / focal_px
}

/// The camera constant, a heading and a bearing: the geometry of all three scenarios.
///
/// ```
/// use shutter_range::rse::{PAPER_KAPPA, Shear};
/// // First row of the paper's Table 2: 1/50 s, 8.0591 m/s, 4.17°.
/// let shear = Shear::parallel(PAPER_KAPPA, 0.0);
/// let depth_m = shear.depth_m(4.17_f64.to_radians(), 8.0591, 1.0 / 50.0);
/// assert!((depth_m - 5.2191).abs() < 0.005);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Shear<S> {
    kappa: S,
    bearing: S,
    /// cos ω + sin ω tan α = cos(ω − α)/cos α
    factor: S,
}

impl<S: Scalar> Shear<S> {
    /// Motion parallel to the image plane, ω = 0. *Source*: eq. (3).
    #[must_use]
    pub fn parallel(kappa: S, bearing: S) -> Self {
        Self { kappa, bearing, factor: S::ONE }
    }

    /// Motion perpendicular to it, ω = 90°: the object comes nearer. *Source*: eqs. (8)–(10).
    #[must_use]
    pub fn perpendicular(kappa: S, bearing: S) -> Self {
        Self { kappa, bearing, factor: bearing }
    }

    /// Motion at the angle ω in radians. *Source*: eqs. (12) and (13).
    #[must_use]
    pub fn oblique(kappa: S, bearing: S, heading_rad: S) -> Self {
        Self { kappa, bearing, factor: heading_rad.cos() + heading_rad.sin() * bearing }
    }

    /// The sideways shift x of eqs. (9) and (12), in metres, of an object that moves by v Δt: its image moves by f x/h.
    #[must_use]
    pub fn sideways_m(&self, speed_m_s: S, elapsed_s: S) -> S {
        speed_m_s * elapsed_s * self.factor
    }

    /// tan θ, the slope of the edge in pixels per row. *Source*: eqs. (3), (10), (13).
    #[must_use]
    pub fn slope(&self, depth_m: S, speed_m_s: S, frame_readout_s: S) -> S {
        self.depth_times_slope(speed_m_s, frame_readout_s) / depth_m
    }

    /// θ, the RSE angle in radians. *Source*: eqs. (3), (10), (13).
    #[must_use]
    pub fn angle_rad(&self, depth_m: S, speed_m_s: S, frame_readout_s: S) -> S {
        self.slope(depth_m, speed_m_s, frame_readout_s).atan()
    }

    /// h, the depth in metres, from θ in radians. Negative where θ has the wrong sign for the motion; infinite or
    /// saturated where it is zero. *Source*: eqs. (4), (10), (14).
    #[must_use]
    pub fn depth_m(&self, angle_rad: S, speed_m_s: S, frame_readout_s: S) -> S {
        self.depth_times_slope(speed_m_s, frame_readout_s) / angle_rad.tan()
    }

    /// d, the distance in metres, from θ in radians. *Source*: eqs. (7), (11), (14).
    #[must_use]
    pub fn distance_m(&self, angle_rad: S, speed_m_s: S, frame_readout_s: S) -> S {
        distance_m(self.depth_m(angle_rad, speed_m_s, frame_readout_s), self.bearing)
    }

    /// v, the speed in m/s, from θ in radians and h. *Source*: eqs. (3), (10), (13) solved for v.
    #[must_use]
    pub fn speed_m_s(&self, angle_rad: S, depth_m: S, frame_readout_s: S) -> S {
        depth_m * angle_rad.tan() / self.depth_times_slope(S::ONE, frame_readout_s)
    }

    /// s, the readout time of the whole frame in seconds, from θ in radians, h and v. *Source*: eqs. (3), (10), (13)
    /// solved for s.
    #[must_use]
    pub fn frame_readout_s(&self, angle_rad: S, depth_m: S, speed_m_s: S) -> S {
        depth_m * angle_rad.tan() / self.depth_times_slope(speed_m_s, S::ONE)
    }

    fn depth_times_slope(&self, speed_m_s: S, frame_readout_s: S) -> S {
        self.kappa * frame_readout_s * speed_m_s * self.factor
    }
}

/// One end of an edge, for [`range_of_endpoints`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Endpoint<S> {
    /// Bearing to the right, after undistortion: `(x − cx)/fx`.
    pub u: S,
    /// Bearing downwards: `(y − cy)/fy`.
    pub w: S,
    /// Middle of the row's exposure in seconds since frame start.
    pub time_s: S,
    /// One standard deviation of `u`.
    pub sigma: S,
}

/// The exact range of an upright edge from its two ends (the paper's two lights), seen by a level camera that moves
/// with a constant `velocity_m_s` and does not turn: no small angle, no small time.
///
/// ρ = Δu/D with D = (u1 v_z − v_x) Δt + t2 v_z Δu. Sigma includes the noise of both ends and a tilt of `sigma_tilt`
/// (as a slope), which two ends cannot tell from distance.
///
/// *Errors*: a number that is not finite, a sigma that is not positive, or both ends at the same time.
///
/// *Source*: eqs. (2), (8), (12) without their approximation, docs/model.md, section 2: (x1, t1) and (x2, t2) give
/// Z(t2) = (u1 v_z − v_x)(t2 − t1)/(u2 − u1), and Z(0) = Z(t2) + v_z t2.
pub fn range_of_endpoints<S: Scalar>(
    first: Endpoint<S>,
    second: Endpoint<S>,
    velocity_m_s: [S; 3],
    sigma_tilt: S,
) -> Result<Estimate<S>, ParameterError> {
    for end in [&first, &second] {
        for (name, value) in [("u", end.u), ("w", end.w), ("time_s", end.time_s), ("sigma", end.sigma)] {
            if !value.is_finite() {
                return Err(ParameterError::new(name, value.to_f64(), "finite"));
            }
        }
        if !(end.sigma > S::ZERO) {
            return Err(ParameterError::new("sigma", end.sigma.to_f64(), "above zero"));
        }
    }
    if !(sigma_tilt >= S::ZERO && sigma_tilt.is_finite()) {
        return Err(ParameterError::new("sigma_tilt", sigma_tilt.to_f64(), "zero or above"));
    }
    let [vx, _, vz] = velocity_m_s;
    if !(vx.is_finite() && vz.is_finite()) {
        return Err(ParameterError::new("velocity_m_s", (vx + vz).to_f64(), "finite"));
    }
    let elapsed = second.time_s - first.time_s;
    if elapsed == S::ZERO {
        return Err(ParameterError::new("time_s", second.time_s.to_f64(), "different at the two ends"));
    }
    let across = second.u - first.u;
    let baseline = (first.u * vz - vx) * elapsed + second.time_s * vz * across;
    if baseline == S::ZERO {
        return Ok(Estimate::nothing());
    }
    let rho = across / baseline;
    // 1 − ρ v_z t: depth at the time of each end, relative to that at frame start.
    let nearer = |end: &Endpoint<S>| S::ONE - rho * vz * end.time_s;
    let per_u = |end: &Endpoint<S>| nearer(end) / baseline;
    let noise = |end: &Endpoint<S>| per_u(end) * end.sigma;
    // A lean of β moves u by β w.
    let tilt = (per_u(&second) * second.w - per_u(&first) * first.w) * sigma_tilt;
    // a = u1 (1 − ρ v_z t1) + ρ v_x t1 = u1 + ρ t1 (v_x − u1 v_z)
    let lever = first.time_s * (vx - first.u * vz);
    let bearing = first.u + rho * lever;
    let of_first = nearer(&first) * first.sigma - lever * noise(&first);
    let of_second = lever * noise(&second);
    let of_tilt = nearer(&first) * first.w * sigma_tilt + lever * tilt;
    let noise_rho = hypot(noise(&first), noise(&second)).max(S::EPSILON);
    let sigma_rho = hypot(noise_rho, tilt);
    let sigma_bearing = hypot(hypot(of_first, of_second), of_tilt).max(S::EPSILON);
    // Sums of products of parts: squares of small sigmas would leave no digits in fixed point.
    let product = |a: S, rho: S| (a / sigma_bearing) * (rho / sigma_rho);
    let correlation = product(of_tilt, tilt) + product(of_second, noise(&second)) - product(of_first, noise(&first));
    if !([rho, bearing, sigma_rho, sigma_bearing, correlation].into_iter().all(S::is_finite)) {
        // A motion next to nothing: the quotients have left the range of the type.
        return Ok(Estimate::nothing());
    }
    Ok(Estimate {
        bearing,
        inverse_depth_per_m: rho,
        sigma_bearing,
        sigma_inverse_depth_per_m: sigma_rho.min(S::UNKNOWN),
        sigma_tilt,
        correlation: correlation.max(-S::ONE).min(S::ONE),
        distance_per_depth: (S::ONE + bearing * bearing).sqrt(),
        budget: Budget { lean_per_m: tilt.abs().min(S::UNKNOWN), ..Budget::of_noise(noise_rho.min(S::UNKNOWN)) },
        ..Estimate::nothing()
    })
}
