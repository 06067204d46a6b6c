//! No transcendental built-ins where heights are computed.

use super::{Finding, Lint, SourceFile};

pub(super) const LINT: Lint = Lint {
    name: "transcendental",
    summary: "the built-ins pow, exp, exp2, log, log2 and tanh are banned in lib/, driver/ and brush/",
    why: "their accuracy differs by driver, so the same stroke would give different heights",
    fix: "use lib/transcendental.wgsl, or compute the value on the CPU where it does not change over the samples",
};

const NAMES: &[&str] = &["exp", "exp2", "log", "log2", "pow", "tanh"];
const FOLDERS: &[&str] = &["brush/", "driver/", "lib/"];

pub(super) fn check(file: &SourceFile<'_>) -> Vec<Finding> {
    if !FOLDERS.iter().any(|folder| file.path.starts_with(folder)) {
        return Vec::new();
    }
    let message = |name| format!("the built-in `{name}` is banned here");
    file.calls(NAMES).map(|call| Finding { offset: call.offset, message: message(call.text) }).collect()
}

#[cfg(test)]
mod tests {
    use super::NAMES;
    use crate::compile::tests::{KERNEL, kernel, lints_of};

    #[test]
    fn accepts_them_elsewhere_and_as_parts_of_names() {
        let source = kernel("let exp = exp2(x); let log_sum = abs(exp);", "log_sum");
        assert_eq!(lints_of(&[("field/normal.wgsl", &source)]), []);
        let source = kernel("let exp = x; let log_sum = abs(exp); // pow(x, 2.0)", "log_sum");
        assert_eq!(lints_of(&[("brush/raise.wgsl", &source)]), []);
    }

    #[test]
    fn rejects_each_of_them() {
        for name in NAMES {
            let arguments = if *name == "pow" { "x, 2.0" } else { "x" };
            let source = kernel(&format!("let y = {name}({arguments});"), "y");
            let expected = [("transcendental", "shaders/brush/raise.wgsl:4:13")];
            assert_eq!(lints_of(&[("brush/raise.wgsl", &source)]), expected, "{name}");
        }
    }

    #[test]
    fn rejects_them_in_functions_that_nothing_calls() {
        let lib = "fn unused(x: f32) -> f32 {\n    return exp(x);\n}\n";
        let kernel = format!("#include \"lib/a.wgsl\"\n{KERNEL}");
        let files = [("lib/a.wgsl", lib), ("brush/raise.wgsl", kernel.as_str())];
        assert_eq!(lints_of(&files), [("transcendental", "shaders/lib/a.wgsl:2:12")]);
    }
}
