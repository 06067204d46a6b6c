//! Modules of `lib/` hold no bindings.

use super::super::tree::Folder;
use super::{Finding, Lint, SourceFile};

pub(super) const LINT: Lint = Lint {
    name: "lib_purity",
    summary: "a file in lib/ declares no bindings",
    why: "any kernel may include it, and bindings of its own would meet the kernel's",
    fix: "take the value as a function's argument, or declare the binding in driver/",
};

pub(super) fn check(file: &SourceFile<'_>) -> Vec<Finding> {
    if file.folder != Some(Folder::Lib) {
        return Vec::new();
    }
    // `@group` and `@binding` come together; one of them is one mistake.
    let bindings = file.attributes(&["binding"]);
    bindings.map(|(name, _)| Finding { offset: name.offset, message: LINT.summary.to_owned() }).collect()
}

#[cfg(test)]
mod tests {
    use crate::compile::tests::{KERNEL, lints_of};

    fn including(folder_file: &str) -> String {
        format!("#include \"{folder_file}\"\n{KERNEL}")
    }

    #[test]
    fn accepts_functions_and_constants() {
        let lib = "const LIMIT = 2u; // @binding(0)\nfn half(x: f32) -> f32 { return 0.5 * x; }\n";
        assert_eq!(lints_of(&[("lib/a.wgsl", lib), ("brush/raise.wgsl", &including("lib/a.wgsl"))]), []);
    }

    #[test]
    fn accepts_bindings_in_a_driver() {
        let driver = "@group(1) @binding(9) var<uniform> brush: vec4<f32>;\n";
        let files = [("driver/a.wgsl", driver), ("brush/raise.wgsl", &including("driver/a.wgsl"))];
        assert_eq!(lints_of(&files), []);
    }

    #[test]
    fn rejects_bindings() {
        let lib = "@group(1) @binding(9) var<uniform> brush: vec4<f32>;\n";
        let files = [("lib/a.wgsl", lib), ("brush/raise.wgsl", &including("lib/a.wgsl"))];
        assert_eq!(lints_of(&files), [("lib_purity", "shaders/lib/a.wgsl:1:12")]);
    }
}
