//! Equations: LaTeX in the pages, MathML in the site, which browsers typeset without a script or a network.

use papilio_diagnostics::Diagnostic;
use pulldown_latex::config::{DisplayMode, RenderConfig};
use pulldown_latex::{Parser, Storage, push_mathml};

use crate::html::escape;

/// Returns the MathML of an equation; `block` for an equation on a line of its own.
pub(crate) fn mathml(latex: &str, block: bool) -> Result<String, Diagnostic> {
    // GitHub also accepts $`...`$.
    let latex = latex.strip_prefix('`').and_then(|inner| inner.strip_suffix('`')).unwrap_or(latex).trim();
    let storage = Storage::new();
    let events: Vec<_> = Parser::new(latex, &storage).collect();
    if let Some(Err(error)) = events.iter().find(|event| event.is_err()) {
        let reason = error.to_string();
        let first = reason.lines().next().unwrap_or_default().to_owned();
        return Err(Diagnostic::new(format!("this equation cannot be read: {first}"))
            .hint("equations are written in LaTeX with amsmath, as GitHub shows them; write a dollar sign of the text as \\$"));
    }
    let annotation = escape(latex);
    let config = RenderConfig {
        display_mode: if block { DisplayMode::Block } else { DisplayMode::Inline },
        annotation: Some(&annotation),
        ..RenderConfig::default()
    };
    let mut written = String::new();
    push_mathml(&mut written, events.into_iter(), config)
        .map_err(|error| Diagnostic::new(format!("this equation cannot be written as MathML: {error}")))?;
    Ok(with_sides(&written.replace("<mo><</mo>", "<mo>&lt;</mo>"), latex))
}

/// Bars that open and close, as the crate writes them.
const BARS: [&str; 2] = [
    "<mo symmetric=\"false\" stretchy=\"false\">|</mo>",
    "<mo symmetric=\"false\" stretchy=\"false\">‖</mo>",
];

/// States for each bar of `\lvert` and `\rvert` on which side it stands. Otherwise, a browser sets it as an
/// operator, with blanks.
fn with_sides(mathml: &str, latex: &str) -> String {
    let mut written = String::with_capacity(mathml.len());
    let mut rest = mathml;
    let commands = latex.split('\\').skip(1);
    for form in commands.filter_map(|command| match command.get(..5) {
        Some("lvert" | "lVert") => Some("prefix"),
        Some("rvert" | "rVert") => Some("postfix"),
        _ => None,
    }) {
        let Some(at) = BARS.iter().filter_map(|bar| rest.find(bar)).min() else { break };
        let start = at + "<mo".len();
        written += &format!("{} form=\"{form}\"", &rest[..start]);
        rest = &rest[start..];
    }
    written + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equation_becomes_mathml_with_its_source() {
        let written = mathml(r"\frac{L}{n^2}", false).unwrap();
        assert!(written.starts_with("<math"), "{written}");
        assert!(
            written.contains(
                "<mfrac><mrow><mi>L</mi></mrow><mrow><msup><mi>n</mi><mn>2</mn></msup></mrow></mfrac>"
            ),
            "{written}"
        );
        assert!(
            written.contains(r#"<annotation encoding="application/x-tex">\frac{L}{n^2}</annotation>"#),
            "{written}"
        );
        assert!(mathml("x", true).unwrap().contains("display=\"block\""));
    }

    #[test]
    fn bars_state_their_side_and_comparisons_are_escaped() {
        let written = mathml(r"\lvert a \rvert \le \lVert b \rVert < c<d", false).unwrap();
        let forms: Vec<_> =
            written.split("form=\"").skip(1).filter_map(|part| part.split('"').next()).collect();
        assert_eq!(forms, ["prefix", "postfix", "prefix", "postfix"], "{written}");
        assert!(written.contains("<mo>&lt;</mo>") && !written.contains("<d"), "{written}");
        assert!(written.contains("&lt; c&lt;d</annotation>"), "{written}");
    }

    #[test]
    fn every_construct_of_the_theory_pages_is_covered() {
        for latex in [
            r"\int_0^{2\pi}\!\int_0^{\pi/2} f_r(\theta_i, \phi) \cos\theta \sin\theta \,\mathrm{d}\theta\,\mathrm{d}\phi \le 1",
            r"\sum_{k=1}^{N} \frac{1}{\sqrt{2\pi}\,\sigma_k} \exp\left(-\frac{x^2}{2\sigma_k^2}\right)",
            r"\begin{aligned} a &= b + c \\ &= d \end{aligned}",
            r"\begin{pmatrix} \cos\delta & \frac{i}{\eta}\sin\delta \\ i\eta\sin\delta & \cos\delta \end{pmatrix}",
            r"R(\lambda) = \begin{cases} 0 & \text{if } |\beta| > 1 \\ \bar{R} & \text{otherwise} \end{cases}",
            r"\hat{\mathbf{n}} \cdot \vec{\omega} \approx \tfrac12 \overline{T} \ll \infty, \quad \Delta E_{00}^* \in [0, 1]",
            r"\boldsymbol{\beta} = n \sin\theta\,(\cos\phi, \sin\phi), \qquad \operatorname{erf}(x) \mapsto \mathcal{F}\{f\}",
            r"\left.\frac{\partial f}{\partial x}\right|_{x=0} \underbrace{a+b}_{\text{both}} \propto \dot{x}\pm\lfloor y \rfloor",
        ] {
            let written = mathml(latex, true).unwrap();
            assert!(!written.contains("merror"), "{latex}: {written}");
        }
    }

    #[test]
    fn wrong_equation_is_a_message() {
        for latex in [r"\frac{1}{", r"\nosuchcommand x", "x^{2"] {
            assert!(mathml(latex, false).unwrap_err().message.contains("cannot be read"), "{latex}");
        }
    }
}
