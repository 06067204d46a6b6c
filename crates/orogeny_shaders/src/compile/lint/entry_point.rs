//! One entry point named `main` in each entry-point file, and none elsewhere.

use super::super::tree::Folder;
use super::{Finding, Lint, SourceFile};

pub(super) const LINT: Lint = Lint {
    name: "entry_point",
    summary: "an entry-point file has exactly one entry point, named `main`; lib/ and driver/ have none",
    why: "one stage has one file and one name everywhere: shader, reference, kernel and test",
    fix: "give each entry point its own file below brush/, custom/, editor/, field/ or terrain/ and call it `main`",
};

const STAGES: &[&str] = &["compute", "fragment", "vertex"];

pub(super) fn check(file: &SourceFile<'_>) -> Vec<Finding> {
    let entry_points = file.attributes(STAGES);
    if file.folder != Some(Folder::Entry) {
        let message = "an entry point outside the entry-point folders";
        return entry_points.map(|(stage, _)| finding(stage.offset, message)).collect();
    }

    let mut findings = Vec::new();
    let mut num_entry_points = 0;
    for (stage, rest) in entry_points {
        num_entry_points += 1;
        if num_entry_points > 1 {
            findings.push(finding(stage.offset, "a second entry point in this file"));
        }
        let name = rest.iter().skip_while(|token| token.text != "fn").nth(1);
        if let Some(name) = name.filter(|name| name.text != "main") {
            findings
                .push(finding(name.offset, &format!("the entry point is named `{}`, not `main`", name.text)));
        }
    }
    if num_entry_points == 0 {
        findings.push(finding(0, "no entry point in this file"));
    }
    findings
}

fn finding(offset: usize, message: &str) -> Finding {
    Finding { offset, message: message.to_owned() }
}

#[cfg(test)]
mod tests {
    use crate::compile::tests::{KERNEL, lints_of};

    const PATH: &str = "brush/raise.wgsl";

    #[test]
    fn accepts_one_main() {
        let source = format!("// @compute\nfn helper() -> u32 {{ return 1u; }}\n{KERNEL}");
        assert_eq!(lints_of(&[(PATH, &source)]), []);
    }

    #[test]
    fn rejects_another_name() {
        let source = KERNEL.replace("fn main", "fn raise");
        assert_eq!(lints_of(&[(PATH, &source)]), [("entry_point", "shaders/brush/raise.wgsl:3:4")]);
    }

    #[test]
    fn rejects_none() {
        assert_eq!(
            lints_of(&[(PATH, "fn main() -> u32 { return 1u; }\n")]),
            [("entry_point", "shaders/brush/raise.wgsl:1:1")]
        );
    }

    #[test]
    fn rejects_a_second() {
        let source = format!("{KERNEL}@compute @workgroup_size(1)\nfn other() {{}}\n");
        let expected = [
            ("entry_point", "shaders/brush/raise.wgsl:6:2"),
            ("entry_point", "shaders/brush/raise.wgsl:7:4"),
        ];
        assert_eq!(lints_of(&[(PATH, &source)]), expected);
    }

    #[test]
    fn rejects_one_in_lib_and_driver() {
        for folder in ["lib", "driver"] {
            let source = "fn helper() {}\n@compute @workgroup_size(1)\nfn main() {}\n";
            let path = format!("{folder}/a.wgsl");
            let kernel = format!("#include \"{path}\"\n{}", KERNEL.replace("fn main", "fn main_"));
            let found = lints_of(&[(&path, source), (PATH, &kernel)]);
            let place = format!("shaders/{path}:2:2");
            assert!(found.contains(&("entry_point", place.as_str())), "{found:?}");
        }
    }
}
