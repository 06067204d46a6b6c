//! Shared files that nothing includes.

use std::collections::BTreeSet;

use super::super::tree::{Folder, SourceTree};
use super::Lint;

pub(super) const LINT: Lint = Lint {
    name: "orphan",
    summary: "every file in lib/ and driver/ is included by an entry-point file",
    why: "what nothing includes is not what it says: nobody runs or tests it",
    fix: "include it where it is needed, or delete it",
};

pub(super) fn check<'a>(
    tree: &'a SourceTree,
    included: &BTreeSet<String>,
) -> impl Iterator<Item = (&'a str, &'static str)> {
    let shared = tree.paths_in(Folder::Lib).chain(tree.paths_in(Folder::Driver));
    shared
        .filter(|path| !included.contains(*path))
        .map(|path| (path, "no entry-point file includes this file"))
}

#[cfg(test)]
mod tests {
    use crate::compile::tests::{KERNEL, lints_of};

    const LIB: &str = "const ONE = 1u;\n";

    #[test]
    fn accepts_what_is_included_directly_or_through_another_file() {
        let kernel = format!("#include \"driver/a.wgsl\"\n{KERNEL}");
        let driver = "#include \"lib/a.wgsl\"\n";
        let files = [("lib/a.wgsl", LIB), ("driver/a.wgsl", driver), ("brush/raise.wgsl", kernel.as_str())];
        assert_eq!(lints_of(&files), []);
    }

    #[test]
    fn rejects_what_only_an_orphan_includes() {
        let driver = "#include \"lib/a.wgsl\"\n";
        let files = [("lib/a.wgsl", LIB), ("driver/a.wgsl", driver), ("brush/raise.wgsl", KERNEL)];
        let expected = [("orphan", "shaders/driver/a.wgsl:1:1"), ("orphan", "shaders/lib/a.wgsl:1:1")];
        assert_eq!(lints_of(&files), expected);
    }
}
