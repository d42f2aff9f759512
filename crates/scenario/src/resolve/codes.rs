//! `codes` of `[display.pixel]`: the code of each state of a picture.

use papilio_diagnostics::Diagnostic;
use papilio_formats::panel::Controller;

use super::Resolver;
use crate::describe::codes::Codes;
use crate::mistake;
use crate::origin::Origin;
use crate::read::Spanned;

/// What the controller of a panel calls the states of a picture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PanelCodes {
    /// The controller, unless the codes are the user's own.
    pub controller: Option<&'static Controller>,
    /// State and code, in the order of the states of the picture.
    pub of_states: Vec<(String, u8)>,
}

impl Resolver<'_> {
    /// The codes of the states of a picture; `known` are all states of the display.
    pub(super) fn codes(
        &mut self,
        codes: &Spanned<Option<Codes>>,
        used: &[String],
        known: &[String],
    ) -> Option<PanelCodes> {
        let (controller, found): (_, Vec<(&String, Option<u8>)>) = match codes.value.as_ref()? {
            Codes::Of(named) => {
                let controller = named.0.0;
                (Some(controller), used.iter().map(|state| (state, controller.code(state))).collect())
            }
            Codes::Own(own) => {
                for item in own.0.iter().filter(|item| !known.contains(&item.name)) {
                    self.errors.push(item.name_origin, mistake::no_such_state(&item.name, known));
                }
                let code = |state: &String| own.get(state).map(|code| code.0 as u8);
                (None, used.iter().map(|state| (state, code(state))).collect())
            }
        };
        let missing: Vec<&str> =
            found.iter().filter(|(_, code)| code.is_none()).map(|(state, _)| state.as_str()).collect();
        if !missing.is_empty() {
            self.errors.push(codes.origin, without_code(controller, &missing));
            return None;
        }
        let of_states: Vec<(String, u8)> =
            found.into_iter().filter_map(|(state, code)| Some((state.clone(), code?))).collect();
        self.check_different(codes.origin, &of_states)?;
        Some(PanelCodes { controller, of_states })
    }

    /// Checks that no two states have the same code: the panel would show one state for both.
    fn check_different(&mut self, at: Origin, codes: &[(String, u8)]) -> Option<()> {
        let twice = codes.iter().enumerate().find_map(|(number, (state, code))| {
            let before = codes[..number].iter().find(|(_, other)| other == code)?;
            Some((&before.0, state, code))
        });
        let Some((first, second, code)) = twice else { return Some(()) };
        let wrong = Diagnostic::new(format!("the states `{first}` and `{second}` have the same code {code}"))
            .expected("a different code for each state: the panel shows one state for each code")
            .hint(
                "give one of them another code, or leave it out: image.states lists the states that are used",
            );
        self.errors.push(at, wrong);
        None
    }
}

/// States that have no code.
fn without_code(controller: Option<&Controller>, missing: &[&str]) -> Diagnostic {
    let names: Vec<String> = missing.iter().map(|state| format!("`{state}`")).collect();
    let (what, names) = (if names.len() == 1 { "state" } else { "states" }, names.join(", "));
    match controller {
        Some(controller) => {
            let known: Vec<&str> = controller.codes.iter().map(|(state, _)| *state).collect();
            let known = known.join(", ");
            Diagnostic::new(format!("the controller `{}` has no code for the {what} {names}", controller.name))
                .expected(format!("a controller with all states of the picture; this one has {known}"))
                .hint(
                    "write codes of your own, codes = { black = 0, white = 1 }, or leave states out: image.states lists those that are \
                     used",
                )
        }
        None => Diagnostic::new(format!("a code for the {what} {names} is missing"))
            .expected("a code for each state of the picture")
            .hint("add codes, or leave states out: image.states lists those that are used"),
    }
}
