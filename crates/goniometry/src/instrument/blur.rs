//! Effect of an instrument's finite resolution on a lobe.

use papilio_optics::lobe::Lobe;
use papilio_optics::{Beta, Scatterer};

use super::quadrature::Rule;

/// Distance in widths from which the kernel and the lobe have separate quadratures.
const SEPARATE: f64 = 1.5;
/// Half width at half maximum of a k-correlation lobe of width 1.
pub(super) const HALF: f64 = 0.766_420_937;

/// Lobe of light from one direction, convolved with the k-correlation kernel of an instrument.
///
/// The integrand is the product of two lobes: the kernel about the viewing direction, and the sample's lobe
/// about the specular direction. If they are well separated, each is integrated over the half plane on its
/// side, in polar coordinates about its centre, graded by its width. If they are close, the coordinates of
/// the narrower lobe are used for the whole plane. The relative error is below 1e-4. For lobes that vanish at
/// the horizon like the square root of the cosine, it is below 5e-4 of the nearby values.
pub(super) struct BlurredLobe<'a> {
    pub(super) rule: &'a Rule,
    pub(super) f: &'a dyn Fn(Beta, Beta) -> f64,
    pub(super) from: Beta,
    /// Width of the kernel, direction cosines; 0 for none.
    pub(super) blur: f64,
    width: f64,
    /// Fraction that is not scattered; its image is the kernel.
    straight: f64,
}

impl<'a> BlurredLobe<'a> {
    pub(super) fn new(rule: &'a Rule, f: &'a dyn Fn(Beta, Beta) -> f64, from: Beta, blur: f64) -> Self {
        Self { rule, f, from, blur, width: width(f, from), straight: 0.0 }
    }

    /// Adds unscattered light.
    pub(super) fn with_straight(self, straight: f64) -> Self {
        Self { straight, ..self }
    }

    /// Returns f as measured by the instrument.
    pub(super) fn value(&self, to: Beta) -> f64 {
        if self.blur == 0.0 {
            return (self.f)(self.from, to);
        }
        let kernel = Lobe::KCorrelation { width: self.blur };
        let product = |beta: Beta| (self.f)(self.from, beta) * kernel.density(beta, to);
        let distance = (to - self.from).length();
        let straight = self.straight * kernel.density(self.from, to);
        straight
            + if distance > SEPARATE * self.blur.max(self.width) {
                self.rule.half_plane(to, self.from, self.blur, product)
                    + self.rule.half_plane(self.from, to, self.width, product)
            } else if self.blur < self.width {
                self.rule.plane(to, self.blur, true, product)
            } else {
                self.rule.plane(self.from, self.width, true, product)
            }
    }

    /// Light that the sample sends into the hemisphere: its total integrated scatter.
    pub(super) fn total(&self) -> f64 {
        self.straight + self.rule.plane(self.from, self.width, false, |beta| (self.f)(self.from, beta))
    }

    /// Integral of the measured values: the kernel moves some light beyond the horizon.
    pub(super) fn measured_total(&self) -> f64 {
        if self.blur == 0.0 {
            return self.total();
        }
        let kernel = Lobe::KCorrelation { width: self.blur };
        let remaining = |beta: Beta| (self.f)(self.from, beta) * kernel.fraction_in_disc(beta.length(), 1.0);
        self.straight * kernel.fraction_in_disc(self.from.length(), 1.0)
            + self.rule.plane(self.from, self.width, true, remaining)
    }
}

/// Width of a k-correlation lobe with the same half width, the smallest of four directions; 1 without
/// a peak.
fn width(f: &dyn Fn(Beta, Beta) -> f64, from: Beta) -> f64 {
    let peak = f(from, from);
    let narrow = |x: f64, y: f64| {
        let mut r = 1e-4;
        while r < HALF && f(from, from + Beta { x: r * x, y: r * y }) > 0.5 * peak {
            r *= 1.2;
        }
        r / HALF
    };
    [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)]
        .map(|(x, y)| narrow(x, y))
        .into_iter()
        .fold(1.0, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The convolution of two k-correlation lobes has the sum of their widths.
    #[test]
    fn widths_of_lobe_and_blur_add() {
        let rule = Rule::new();
        for (width, blur) in [(0.03869, 0.0483), (0.06295, 0.0483), (0.005, 0.0483), (0.1, 0.01), (0.3, 0.05)]
        {
            let lobe = Lobe::KCorrelation { width };
            let f = move |from: Beta, to: Beta| 0.9 * lobe.density(from, to);
            let sum = Lobe::KCorrelation { width: width + blur };
            for theta in [0.0_f64, 30.0, 75.0] {
                let from = Beta { x: theta.to_radians().sin(), y: 0.0 };
                let blurred = BlurredLobe::new(&rule, &f, from, blur);
                for r in [0.0, 0.01, 0.03, 0.06, 0.07, 0.1, 0.2, 0.5, 1.0] {
                    for (cos, sin) in [(1.0, 0.0), (-0.6, 0.8), (-1.0, 0.0)] {
                        let to = from + Beta { x: r * cos, y: r * sin };
                        if to.squared() > 1.0 {
                            continue;
                        }
                        let error = blurred.value(to) / (0.9 * sum.density(from, to)) - 1.0;
                        assert!(error.abs() < 1e-4, "{width} {blur} {theta} {r} {cos}: {error}");
                    }
                }
                let (total, measured) = (blurred.total(), blurred.measured_total());
                let exact = [width, width + blur]
                    .map(|width| 0.9 * Lobe::KCorrelation { width }.fraction_in_disc(from.x, 1.0));
                assert!((total / exact[0] - 1.0).abs() < 1e-4, "{width} {theta}: {total} {exact:?}");
                assert!((measured / exact[1] - 1.0).abs() < 1e-4, "{width} {theta}: {measured} {exact:?}");
            }
        }
    }

    /// Lobes that end at the horizon, compared with a rule with three times as many nodes.
    #[test]
    fn blur_of_lobes_with_an_edge_converges() {
        let f = |from: Beta, to: Beta| {
            let inside = 1.0 - to.squared();
            if inside > 0.0 { (-(to - from).squared() / 0.04).exp() * inside.sqrt() } else { 0.0 }
        };
        let rules = [Rule::new(), Rule::times(3)];
        for x in [0.0, 0.7, 0.96] {
            let from = Beta { x, y: 0.0 };
            for to in [(0.0, 0.0), (0.5, 0.5), (0.9, 0.1), (0.98, -0.1), (-0.9, 0.0)] {
                let to = Beta { x: to.0, y: to.1 };
                let [coarse, fine] = [0, 1].map(|k| BlurredLobe::new(&rules[k], &f, from, 0.0483).value(to));
                assert!((coarse - fine).abs() < 5e-4 * fine.max(3e-3), "{x} {to:?}: {coarse} {fine}");
            }
        }
    }
}
