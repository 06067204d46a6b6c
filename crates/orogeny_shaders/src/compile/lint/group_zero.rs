//! Bind group 0 belongs to the frame.

use naga::{Module, Span};

use super::super::resolve::Flattened;
use super::super::tree::Folder;
use super::super::validate;
use super::Lint;

pub(super) const LINT: Lint = Lint {
    name: "group_zero",
    summary: "an entry-point file declares its bindings in group 1 and above",
    why: "group 0 is bound once a frame, for the document, and stays bound over all pipelines",
    fix: "use group 1 or above; what the whole frame shares is declared in driver/",
};

pub(super) fn check(flattened: &Flattened, module: &Module, mut report: impl FnMut(Span, String)) {
    for (handle, variable) in module.global_variables.iter() {
        let span = module.global_variables.get_span(handle);
        let (path, ..) = validate::place(flattened, span);
        let in_group_zero = variable.binding.is_some_and(|binding| binding.group == 0);
        if in_group_zero && Folder::of(path) == Some(Folder::Entry) {
            let name = variable.name.as_deref().unwrap_or_default();
            report(span, format!("`{name}` is in group 0, which belongs to the frame"));
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::compile::tests::{KERNEL, lints_of};

    #[test]
    fn accepts_group_one() {
        assert_eq!(lints_of(&[("brush/raise.wgsl", KERNEL)]), []);
    }

    #[test]
    fn accepts_the_frame_in_a_driver() {
        let driver = "@group(0) @binding(0) var<uniform> frame: vec4<f32>;\n";
        let kernel = format!("#include \"driver/frame.wgsl\"\n{KERNEL}");
        assert_eq!(lints_of(&[("driver/frame.wgsl", driver), ("brush/raise.wgsl", &kernel)]), []);
    }

    #[test]
    fn rejects_group_zero_in_an_entry_point_file() {
        let source = KERNEL.replace("@group(1)", "@group(0)");
        assert_eq!(
            lints_of(&[("brush/raise.wgsl", &source)]),
            [("group_zero", "shaders/brush/raise.wgsl:1:23")]
        );
    }
}
