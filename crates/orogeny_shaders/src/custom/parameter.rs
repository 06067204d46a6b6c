//! Parameters, which a file declares in its line comments, and its summary, which is the first of the others.

use std::fmt::Write;
use std::ops::Range;

use naga::keywords::wgsl::RESERVED;

use super::rule::Reporter;
use super::{CustomParameter, MAX_PARAMETERS};
use crate::compile::lint::Lint;

pub(super) const LINT: Lint = Lint {
    name: "parameter",
    summary: "a parameter is declared by `// @param name: f32 = default (min .. max) \"meaning\"`, 32 at most",
    why: "it becomes a control with a range and a text, and a number that the brush reads as `parameters.name`",
    fix: "write one line for each, as in: // @param step_m: f32 = 12 (0.5 .. 200) \"height of a step, metres\"",
};

/// More than fits on a line beside a control.
const MAX_MEANING_CHARS: usize = 160;

/// What the comments of a file say.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Declarations {
    pub parameters: Vec<CustomParameter>,
    pub summary: String,
}

impl Declarations {
    /// The uniform of the parameters.
    pub(super) fn wgsl<'a>(&'a self, new_name: impl Fn(&'a str) -> &'a str) -> String {
        let mut members = String::new();
        for parameter in &self.parameters {
            // Writing to a string does not fail.
            let _ = writeln!(members, "    {}: f32,", new_name(&parameter.name));
        }
        if members.is_empty() {
            members.push_str("    unused: f32,\n");
        }
        format!(
            "struct Parameters {{\n{members}}}\n\n\
             @group(1) @binding(11) var<uniform> parameters: Parameters;\n"
        )
    }
}

/// Reads the line comments of a file.
pub(super) fn parse(
    source: &str,
    line_comments: &[Range<usize>],
    reporter: &mut Reporter<'_>,
) -> Declarations {
    let mut declarations = Declarations::default();
    for range in line_comments {
        let comment = source.get(range.clone()).unwrap_or_default();
        let text = comment.trim_start_matches('/').trim();
        let Some(declaration) = text.strip_prefix("@param") else {
            if declarations.summary.is_empty() {
                declarations.summary = text.to_owned();
            }
            continue;
        };
        let start = comment.len() - comment.trim_start_matches('/').trim_start().len();
        let mut cursor = Cursor { rest: declaration, offset: range.start + start + "@param".len() };
        match cursor.parameter() {
            Ok((parameter, offset)) => {
                if let Some(message) = refusal(&parameter, &declarations.parameters) {
                    reporter.at_offset(&LINT, offset, message);
                }
                declarations.parameters.push(parameter);
            }
            Err(message) => reporter.at_offset(&LINT, cursor.offset, message),
        }
    }
    declarations
}

/// Why a parameter of the right form is refused, if so.
fn refusal(parameter: &CustomParameter, others: &[CustomParameter]) -> Option<String> {
    let CustomParameter { name, default, min, max, meaning } = parameter;
    let is_number = [default, min, max].into_iter().all(|value| value.is_finite());
    if name.starts_with("__") || name == "_" || RESERVED.contains(&name.as_str()) {
        Some(format!("WGSL reserves the name `{name}`"))
    } else if others.iter().any(|other| other.name == *name) {
        Some(format!("a second parameter `{name}`"))
    } else if others.len() == MAX_PARAMETERS {
        Some(format!("more than {MAX_PARAMETERS} parameters"))
    } else if !is_number {
        Some(format!("a number of `{name}` is none that an f32 holds"))
    } else if min >= max {
        Some(format!("the range of `{name}` is empty"))
    } else if !(min..=max).contains(&default) {
        Some(format!("the default of `{name}`, {default}, is not within {min} .. {max}"))
    } else {
        let num_chars = meaning.chars().count();
        (!(1..=MAX_MEANING_CHARS).contains(&num_chars))
            .then(|| format!("the meaning of `{name}` has not 1 to {MAX_MEANING_CHARS} characters"))
    }
}

/// What is left of a declaration, and where that is in the file.
struct Cursor<'a> {
    rest: &'a str,
    offset: usize,
}

impl<'a> Cursor<'a> {
    /// ` step_m: f32 = 12 (0.5 .. 200) "height of a step, metres"`, and where the name is.
    fn parameter(&mut self) -> Result<(CustomParameter, usize), String> {
        if !self.rest.starts_with(char::is_whitespace) {
            return Err("expected a space after `@param`".to_owned());
        }
        self.skip_spaces();
        let offset = self.offset;
        let name = self.name("a name: letters, digits and `_`")?;
        self.expect(":")?;
        self.skip_spaces();
        let type_offset = (self.rest, self.offset);
        let type_name = self.name("the type `f32`")?;
        if type_name != "f32" {
            (self.rest, self.offset) = type_offset;
            return Err(format!("`{type_name}` is no type of a parameter; only `f32` is"));
        }
        self.expect("=")?;
        let default = self.number("the default")?;
        self.expect("(")?;
        let min = self.number("the least value")?;
        self.expect("..")?;
        let max = self.number("the largest value")?;
        self.expect(")")?;
        self.expect("\"")?;
        let meaning = self.take(self.rest.find('"').ok_or("expected a `\"` after the meaning")?);
        self.expect("\"")?;
        self.skip_spaces();
        if !self.rest.is_empty() {
            return Err("expected nothing after the meaning".to_owned());
        }
        let (name, meaning) = (name.to_owned(), meaning.trim().to_owned());
        Ok((CustomParameter { name, default, min, max, meaning }, offset))
    }

    fn take(&mut self, num_bytes: usize) -> &'a str {
        let (taken, rest) = self.rest.split_at_checked(num_bytes).unwrap_or((self.rest, ""));
        self.rest = rest;
        self.offset += taken.len();
        taken
    }

    fn skip_spaces(&mut self) {
        self.take(self.rest.len() - self.rest.trim_start().len());
    }

    fn expect(&mut self, expected: &str) -> Result<(), String> {
        self.skip_spaces();
        if !self.rest.starts_with(expected) {
            return Err(format!("expected `{expected}`"));
        }
        self.take(expected.len());
        Ok(())
    }

    fn name(&mut self, expected: &str) -> Result<&'a str, String> {
        let is_end = |c: char| !c.is_ascii_alphanumeric() && c != '_';
        let num_bytes = self.rest.find(is_end).unwrap_or(self.rest.len());
        if num_bytes == 0 || self.rest.starts_with(|c: char| c.is_ascii_digit()) {
            return Err(format!("expected {expected}"));
        }
        Ok(self.take(num_bytes))
    }

    /// A number of Rust's form, up to a space, a bracket or the dots of a range.
    fn number(&mut self, expected: &str) -> Result<f32, String> {
        self.skip_spaces();
        let is_end = |c: char| c.is_whitespace() || matches!(c, '(' | ')' | '"');
        let num_bytes = self.rest.find(is_end).unwrap_or(self.rest.len());
        let text = self.rest.get(..num_bytes).unwrap_or_default();
        let text = text.split_once("..").map_or(text, |(before, _)| before);
        let number = text.parse().map_err(|_| format!("expected {expected}, a number"))?;
        self.take(text.len());
        Ok(number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::custom::tests::{compiled, errors_of, rules_of};

    const REST: &str = "fn brush(at: BrushInput) -> f32 { return at.height_m; }\n";

    fn parameter(name: &str, [default, min, max]: [f32; 3], meaning: &str) -> CustomParameter {
        CustomParameter { name: name.to_owned(), default, min, max, meaning: meaning.to_owned() }
    }

    #[test]
    fn accepts_declarations_wherever_they_stand() {
        let text = format!(
            "/* // @param no: f32 = x */\n//   Steps.  \n// @param step_m: f32 = 12 (0.5 .. 200) \"height\"\n\
             //@param b:f32=-1e-3(-1..1)\"b (c) .. d\"\n{REST}// More.\n  // @param _c: f32 = 0 (0. .. .5) \" e \" \n"
        );
        let brush = compiled(&text);
        assert_eq!(brush.summary, "Steps.");
        assert_eq!(
            brush.parameters,
            [
                parameter("step_m", [12.0, 0.5, 200.0], "height"),
                parameter("b", [-1e-3, -1.0, 1.0], "b (c) .. d"),
                parameter("_c", [0.0, 0.0, 0.5], "e"),
            ]
        );
        let layout = brush.shader.find_struct("Parameters").unwrap();
        assert_eq!(layout.size, 12);
        let names: Vec<_> = layout.members.iter().map(|member| (&*member.name, member.offset)).collect();
        assert_eq!(names, [("step_m", 0), ("b", 4), ("_c", 8)]);
    }

    #[test]
    fn accepts_none() {
        let brush = compiled(REST);
        assert_eq!((brush.parameters, brush.summary.as_str()), (Vec::new(), ""));
        assert_eq!(brush.shader.find_struct("Parameters").unwrap().size, 4);
    }

    #[test]
    fn rejects_other_forms_at_their_place() {
        for (declaration, column, expected) in [
            ("a: u32 = 1 (0 .. 2) \"m\"", 14, "only `f32`"),
            ("a: bool = true", 14, "only `f32`"),
            ("a: = 1 (0 .. 2) \"m\"", 14, "expected the type"),
            ("2a: f32 = 1 (0 .. 2) \"m\"", 11, "expected a name"),
            (": f32 = 1 (0 .. 2) \"m\"", 11, "expected a name"),
            ("a-b: f32 = 1 (0 .. 2) \"m\"", 12, "expected `:`"),
            ("a: f32", 17, "expected `=`"),
            ("a: f32 = one (0 .. 2) \"m\"", 20, "expected the default, a number"),
            ("a: f32 = 1 \"m\"", 22, "expected `(`"),
            ("a: f32 = 1 (0, 2) \"m\"", 23, "expected the least value"),
            ("a: f32 = 1 (0 2) \"m\"", 25, "expected `..`"),
            ("a: f32 = 1 (0 .. ) \"m\"", 28, "expected the largest value"),
            ("a: f32 = 1 (0 .. 2", 29, "expected `)`"),
            ("a: f32 = 1 (0 .. 2)", 30, "expected `\"`"),
            ("a: f32 = 1 (0 .. 2) \"m", 32, "expected a `\"` after the meaning"),
            ("a: f32 = 1 (0 .. 2) \"m\" n", 35, "expected nothing after"),
        ] {
            let errors = errors_of(&format!("\n// @param {declaration}\n{REST}"));
            let [error] = errors.as_slice() else { panic!("{declaration}: {errors:?}") };
            assert!(error.message.contains(expected), "{declaration}: {}", error.message);
            assert_eq!(
                (error.line, error.column, error.lint),
                (2, column, Some("parameter")),
                "{declaration}"
            );
        }
    }

    #[test]
    fn rejects_what_cannot_be_a_parameter() {
        let long = "m".repeat(161);
        for (declaration, expected) in [
            ("loop: f32 = 1 (0 .. 2) \"m\"", "reserves"),
            ("__a: f32 = 1 (0 .. 2) \"m\"", "reserves"),
            ("_: f32 = 1 (0 .. 2) \"m\"", "reserves"),
            ("a: f32 = 3 (0 .. 2) \"m\"", "not within 0 .. 2"),
            ("a: f32 = 1 (2 .. 0) \"m\"", "empty"),
            ("a: f32 = 1 (1 .. 1) \"m\"", "empty"),
            ("a: f32 = nan (0 .. 2) \"m\"", "an f32 holds"),
            ("a: f32 = 1 (0 .. inf) \"m\"", "an f32 holds"),
            ("a: f32 = 1 (0 .. 1e39) \"m\"", "an f32 holds"),
            ("a: f32 = 1 (0 .. 2) \" \"", "1 to 160"),
            (&format!("a: f32 = 1 (0 .. 2) \"{long}\""), "1 to 160"),
        ] {
            let errors = errors_of(&format!("// @param {declaration}\n{REST}"));
            let [error] = errors.as_slice() else { panic!("{declaration}: {errors:?}") };
            assert!(error.message.contains(expected), "{declaration}: {}", error.message);
            assert_eq!((error.line, error.column, error.lint), (1, 11, Some("parameter")), "{declaration}");
        }
    }

    #[test]
    fn rejects_a_second_one_of_a_name_and_a_33rd() {
        let line = |name: String| format!("// @param {name}: f32 = 1 (0 .. 2) \"m\"\n");
        let text = format!("{}{}{REST}", line("a".to_owned()), line("a".to_owned()));
        assert_eq!(rules_of(&text), [("parameter", 2)]);
        let most: String = (0..32).map(|k| line(format!("a{k}"))).collect();
        assert_eq!(compiled(&format!("{most}{REST}")).parameters.len(), 32);
        assert_eq!(rules_of(&format!("{most}{}{REST}", line("b".to_owned()))), [("parameter", 33)]);
    }
}
