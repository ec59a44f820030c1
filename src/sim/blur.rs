//! The blurred step: how much of a pixel lies beyond an edge.

/// Half of the width over which a Gauss differs from 0 and 1, in sigmas: 3·10⁻⁶ is left outside.
const REACH_SIGMAS: f32 = 4.5;

/// Where an edge crosses a row (or a column) and how it is blurred there.
#[derive(Clone, Copy)]
pub(super) struct BlurredStep {
    /// Mean position over the exposure, in pixels.
    pub(super) position: f32,
    /// Way during the exposure, in pixels, not negative.
    pub(super) motion: f32,
    /// Blur of the lens along the row, in pixels, above zero.
    pub(super) sigma: f32,
}

impl BlurredStep {
    pub(super) fn reach(&self) -> f32 {
        0.5 * self.motion + REACH_SIGMAS * self.sigma
    }

    /// Share of the pixel centred at `pixel` that lies beyond the edge, 0 to 1.
    pub(super) fn coverage(&self, pixel: f32) -> f32 {
        let x = pixel - self.position;
        let reach = self.reach();
        if x + 0.5 <= -reach {
            0.0
        } else if x - 0.5 >= reach {
            1.0
        } else {
            self.area(x + 0.5) - self.area(x - 0.5)
        }
    }

    /// Integral up to `x` of the step after motion and lens, x from the edge.
    ///
    /// With K' = Φ(x/σ) and J' = K it is (J(x + b/2) − J(x − b/2))/b. For small motions, where the quotient would lose
    /// its digits, it is the series K + b² K''/24 + b⁴ K⁗/1920, good to 10⁻⁶ up to b = σ/2.
    fn area(&self, x: f32) -> f32 {
        let Self { motion, sigma, .. } = *self;
        let series = motion < 0.5 * sigma;
        if series {
            let z = x / sigma;
            let (below, density) = normal(z);
            let ratio = motion / sigma;
            let r2 = ratio * ratio;
            let spread = density * (1.0 + r2 * (1.0 / 24.0) * (1.0 + r2 * (1.0 / 80.0) * (z * z - 1.0)));
            sigma * (z * below + spread)
        } else {
            let (ahead, behind) = (x + 0.5 * motion, x - 0.5 * motion);
            // Of J the parabola ½x² for x > 0 is taken apart: its difference is exact, and the rest is small.
            let parabolas = if behind > 0.0 {
                x * motion
            } else if ahead > 0.0 {
                0.5 * ahead * ahead
            } else {
                0.0
            };
            let rest = second_area(ahead / sigma) - second_area(behind / sigma);
            (parabolas + sigma * sigma * rest) / motion
        }
    }
}

/// J(z) − ½ max(z, 0)², for sigma one.
fn second_area(z: f32) -> f32 {
    let tail = -z.abs();
    let (below, density) = normal(tail);
    let area = 0.5 * ((tail * tail + 1.0) * below + tail * density);
    if z > 0.0 { 0.5 - area } else { area }
}

/// Φ(z) and φ(z).
fn normal(z: f32) -> (f32, f32) {
    const SQRT_HALF: f32 = core::f32::consts::FRAC_1_SQRT_2;
    const PER_SQRT_TAU: f32 = 0.398_942_3;
    (0.5 * libm::erfcf(-z * SQRT_HALF), PER_SQRT_TAU * libm::expf(-0.5 * z * z))
}

/// A step that is walked along pixel by pixel: each boundary between two pixels is computed once.
pub(super) struct Walk {
    step: BlurredStep,
    /// Pixels up to the first of these lie before the edge as a whole, those from the second on beyond it.
    from: f32,
    to: f32,
    area_before: Option<f32>,
}

impl Walk {
    pub(super) fn new(step: BlurredStep) -> Self {
        let reach = step.reach() + 0.5;
        Self { step, from: step.position - reach, to: step.position + reach, area_before: None }
    }

    /// As [`BlurredStep::coverage`], for one pixel after the other.
    pub(super) fn next(&mut self, pixel: f32) -> f32 {
        if pixel <= self.from {
            return 0.0;
        }
        if pixel >= self.to {
            return 1.0;
        }
        let x = pixel - self.step.position;
        let before = self.area_before.unwrap_or_else(|| self.step.area(x - 0.5));
        let after = self.step.area(x + 0.5);
        self.area_before = Some(after);
        after - before
    }
}

#[cfg(test)]
mod tests {
    use super::BlurredStep;

    /// Against sums over the motion and over the pixel of one Gauss each, in double precision.
    fn summed(step: &BlurredStep, pixel: f64) -> f64 {
        let [position, motion, sigma] = [step.position, step.motion, step.sigma].map(f64::from);
        let mean = |count: u32, part: &dyn Fn(f64) -> f64| {
            let middle = |index| (f64::from(index) + 0.5) / f64::from(count) - 0.5;
            (0..count).map(|index| part(middle(index))).sum::<f64>() / f64::from(count)
        };
        mean(40 + (2.0 * motion / sigma) as u32, &|way| {
            mean(40, &|inside| {
                let z = (pixel + inside - position - way * motion) / sigma;
                0.5 * libm::erfc(-z * core::f64::consts::FRAC_1_SQRT_2)
            })
        })
    }

    #[test]
    fn closed_form_against_sums() {
        for sigma in [0.05, 0.3, 0.7, 3.0] {
            for motion in [0.0, 1e-6, 0.02, 0.14, 0.16, 0.34, 0.36, 1.4, 1.6, 6.0, 30.0] {
                let step = BlurredStep { position: 1000.3, motion, sigma };
                for pixel in 980..1020 {
                    let (got, want) = (step.coverage(pixel as f32), summed(&step, f64::from(pixel)));
                    assert!((f64::from(got) - want).abs() < 2e-4, "{sigma} {motion} {pixel}: {got} for {want}");
                }
            }
        }
    }
}
