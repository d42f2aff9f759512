//! What an instrument of finite resolution sees of a lobe.

use papilio_optics::lobe::Lobe;
use papilio_optics::{Beta, Scatterer};

use super::quadrature::Rule;

/// A lobe whose middle is this many widths from where it is looked at has a quadrature of its own there.
const APART: f64 = 1.5;
/// The half width at half maximum of a k-correlation lobe of width 1.
pub(super) const HALF: f64 = 0.766_420_937;

/// The lobe of light from one direction, convolved with the k-correlation kernel of an instrument.
///
/// Two lobes meet under the integral: the kernel about the direction looked at, and the sample's about
/// the specular direction. Where they are apart, each has the half plane on its side, in polar
/// coordinates about its middle, graded by its width; where they are close, the narrower's coordinates
/// serve for both. Error below 1e-4, relative; below 5e-4 of what is near for lobes that end at the
/// horizon in a root of the cosine.
pub(super) struct Blurred<'a> {
    pub(super) rule: &'a Rule,
    pub(super) f: &'a dyn Fn(Beta, Beta) -> f64,
    pub(super) from: Beta,
    /// Width of the kernel, direction cosines; 0 for none.
    pub(super) blur: f64,
    width: f64,
    /// Share that passes without scattering; its image is the kernel.
    straight: f64,
}

impl<'a> Blurred<'a> {
    pub(super) fn new(rule: &'a Rule, f: &'a dyn Fn(Beta, Beta) -> f64, from: Beta, blur: f64) -> Self {
        Self { rule, f, from, blur, width: width(f, from), straight: 0.0 }
    }

    /// The same with light that passes straight beside the lobe.
    pub(super) fn with_straight(self, straight: f64) -> Self {
        Self { straight, ..self }
    }

    /// f as the instrument sees it.
    pub(super) fn value(&self, to: Beta) -> f64 {
        if self.blur == 0.0 {
            return (self.f)(self.from, to);
        }
        let kernel = Lobe::KCorrelation { width: self.blur };
        let product = |beta: Beta| (self.f)(self.from, beta) * kernel.density(beta, to);
        let apart = (to - self.from).length();
        let straight = self.straight * kernel.density(self.from, to);
        straight
            + if apart > APART * self.blur.max(self.width) {
                self.rule.half_plane(to, self.from, self.blur, product)
                    + self.rule.half_plane(self.from, to, self.width, product)
            } else if self.blur < self.width {
                self.rule.plane(to, self.blur, true, product)
            } else {
                self.rule.plane(self.from, self.width, true, product)
            }
    }

    /// What the sample sends into the hemisphere: its total integrated scatter.
    pub(super) fn total(&self) -> f64 {
        self.straight + self.rule.plane(self.from, self.width, false, |beta| (self.f)(self.from, beta))
    }

    /// The integral of what the instrument sees: the kernel loses some of it beyond the horizon.
    pub(super) fn seen(&self) -> f64 {
        if self.blur == 0.0 {
            return self.total();
        }
        let kernel = Lobe::KCorrelation { width: self.blur };
        let kept = |beta: Beta| (self.f)(self.from, beta) * kernel.fraction_in_disc(beta.length(), 1.0);
        self.straight * kernel.fraction_in_disc(self.from.length(), 1.0)
            + self.rule.plane(self.from, self.width, true, kept)
    }
}

/// The width of a k-correlation lobe with the same half width, the least of four directions; 1 if there is
/// no peak.
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

    /// Of two k-correlation lobes in a row the widths add.
    #[test]
    fn widths_add() {
        let rule = Rule::new();
        for (width, blur) in [(0.03869, 0.0483), (0.06295, 0.0483), (0.005, 0.0483), (0.1, 0.01), (0.3, 0.05)]
        {
            let lobe = Lobe::KCorrelation { width };
            let f = move |from: Beta, to: Beta| 0.9 * lobe.density(from, to);
            let sum = Lobe::KCorrelation { width: width + blur };
            for theta in [0.0_f64, 30.0, 75.0] {
                let from = Beta { x: theta.to_radians().sin(), y: 0.0 };
                let blurred = Blurred::new(&rule, &f, from, blur);
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
                let (total, seen) = (blurred.total(), blurred.seen());
                let exact = [width, width + blur]
                    .map(|width| 0.9 * Lobe::KCorrelation { width }.fraction_in_disc(from.x, 1.0));
                assert!((total / exact[0] - 1.0).abs() < 1e-4, "{width} {theta}: {total} {exact:?}");
                assert!((seen / exact[1] - 1.0).abs() < 1e-4, "{width} {theta}: {seen} {exact:?}");
            }
        }
    }

    /// A lobe that ends at the horizon, by a rule three times as fine.
    #[test]
    fn rims_are_seen_to() {
        let f = |from: Beta, to: Beta| {
            let inside = 1.0 - to.squared();
            if inside > 0.0 { (-(to - from).squared() / 0.04).exp() * inside.sqrt() } else { 0.0 }
        };
        let rules = [Rule::new(), Rule::times(3)];
        for x in [0.0, 0.7, 0.96] {
            let from = Beta { x, y: 0.0 };
            for to in [(0.0, 0.0), (0.5, 0.5), (0.9, 0.1), (0.98, -0.1), (-0.9, 0.0)] {
                let to = Beta { x: to.0, y: to.1 };
                let [coarse, fine] = [0, 1].map(|k| Blurred::new(&rules[k], &f, from, 0.0483).value(to));
                assert!((coarse - fine).abs() < 5e-4 * fine.max(3e-3), "{x} {to:?}: {coarse} {fine}");
            }
        }
    }
}
