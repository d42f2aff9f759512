//! `[pattern]`: states and periods of patterns.

use papilio_display::scene::Scene;
use papilio_display::spatial::Patterns;
use papilio_imaging::text::Font;

use super::Resolver;
use crate::describe::File;
use crate::mistake;

impl Resolver<'_> {
    /// Resolves the patterns; its states must be those of the display.
    pub(super) fn patterns(&mut self, file: &File, scene: &Scene) -> Patterns {
        let Some(asked) = &file.pattern.value else { return Patterns::default() };
        let known = scene.display.state_names();
        for state in [&asked.on, &asked.off] {
            if !known.contains(&state.0) && !asked.period_mm.is_empty() {
                self.err(state, mistake::no_such_state(&state.0, &known));
            }
        }
        let text = &asked.text.0;
        let missing = Font::bundled().missing(text);
        if !missing.is_empty() {
            self.err(&asked.text, mistake::no_glyphs(&missing));
        }
        if text.trim().is_empty() {
            self.warnings
                .push("pattern.text has no letters: the contrast of text is not computed".to_owned());
        }
        Patterns {
            kinds: asked.kind.iter().map(|kind| kind.0).collect(),
            on: asked.on.0.clone(),
            off: asked.off.0.clone(),
            period_mm: asked.period_mm.iter().map(|period| period.0).collect(),
            text: text.clone(),
        }
    }
}
