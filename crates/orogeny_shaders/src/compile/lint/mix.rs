//! `mix` is banned.

use super::{Finding, Lint, SourceFile};

pub(super) const LINT: Lint = Lint {
    name: "mix",
    summary: "`mix` is banned",
    why: "WGSL lets a driver compute it as a + w(b - a) or as a(1 - w) + wb, which round differently",
    fix: "write a + w * (b - a)",
};

pub(super) fn check(file: &SourceFile<'_>) -> Vec<Finding> {
    let finding = |offset| Finding { offset, message: LINT.summary.to_owned() };
    file.calls(&["mix"]).map(|call| finding(call.offset)).collect()
}

#[cfg(test)]
mod tests {
    use crate::compile::tests::{kernel, lints_of};

    #[test]
    fn accepts_a_written_out_lerp() {
        let source = kernel("let mixed = 1.0 + x * (2.0 - 1.0); // mix(a, b, w)", "mixed");
        assert_eq!(lints_of(&[("brush/raise.wgsl", &source)]), []);
    }

    #[test]
    fn rejects_mix() {
        let source = kernel("let y = mix (1.0, 2.0, x);", "y");
        assert_eq!(lints_of(&[("brush/raise.wgsl", &source)]), [("mix", "shaders/brush/raise.wgsl:4:13")]);
    }
}
