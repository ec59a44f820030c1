//! [`BlurredStep`]: how much of a pixel lies beyond a blurred edge.

/// Half-width of a Gaussian step, in sigmas: beyond it the step differs from 0 or 1 by less than 4·10⁻⁶.
const REACH_SIGMAS: f32 = 4.5;

/// Where an edge crosses a row (or a column) and how it is blurred there.
#[derive(Clone, Copy)]
pub(super) struct BlurredStep {
    /// Mean position over the exposure, in pixels.
    pub(super) position: f32,
    /// Length of its path during the exposure, in pixels.
    pub(super) motion: f32,
    /// Blur of the lens along the row, one sigma in pixels, above zero.
    pub(super) sigma: f32,
}

impl BlurredStep {
    /// Half-width of the blur, in pixels.
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

    /// Integral of the step, blurred by motion and lens, up to `x` pixels from the edge.
    ///
    /// With K' = Φ(x/σ), J' = K and the motion b it is (J(x + b/2) − J(x − b/2))/b. For a small motion the quotient
    /// would lose its digits; there the series K + b² K''/24 + b⁴ K⁗/1920 is used, good to 10⁻⁶ up to b = σ/2.
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
            // J is the parabola ½x² for x > 0, whose difference is exact, and a small rest.
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

/// Goes along a step pixel by pixel, so that each boundary between two pixels is computed once.
pub(super) struct Walk {
    step: BlurredStep,
    /// Up to this column pixels lie wholly before the edge.
    from: f32,
    /// From this column on pixels lie wholly beyond the edge.
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

    /// The coverage as a sum of Gaussian steps over the motion and over the pixel, in double precision.
    fn summed(step: &BlurredStep, pixel: f64) -> f64 {
        let [position, motion, sigma] = [step.position, step.motion, step.sigma].map(f64::from);
        let mean = |count: u32, part: &dyn Fn(f64) -> f64| {
            let middle = |index| (f64::from(index) + 0.5) / f64::from(count) - 0.5;
            (0..count).map(|index| part(middle(index))).sum::<f64>() / f64::from(count)
        };
        mean(40 + (2.0 * motion / sigma) as u32, &|path| {
            mean(40, &|inside| {
                let z = (pixel + inside - position - path * motion) / sigma;
                0.5 * libm::erfc(-z * core::f64::consts::FRAC_1_SQRT_2)
            })
        })
    }

    #[test]
    fn the_closed_form_agrees_with_sums() {
        // The sums' own error: h²/24 · φ(0)/σ for steps of h = 1/40 px and a σ of 0.05 px.
        const ERROR_OF_SUMS: f64 = 2e-4;
        for sigma in [0.05, 0.3, 0.7, 3.0] {
            for motion in [0.0, 1e-6, 0.02, 0.14, 0.16, 0.34, 0.36, 1.4, 1.6, 6.0, 30.0] {
                let step = BlurredStep { position: 1000.3, motion, sigma };
                for pixel in 980..1020 {
                    let (got, want) = (step.coverage(pixel as f32), summed(&step, f64::from(pixel)));
                    let error = (f64::from(got) - want).abs();
                    assert!(error < ERROR_OF_SUMS, "{sigma} {motion} {pixel}: {got} for {want}");
                }
            }
        }
    }
}
