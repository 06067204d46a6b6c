//! The names of a user's file and those of the engine, kept apart.
//!
//! WGSL has one scope for all declarations of a module. What a file may see, its library, it may not declare again.
//! All other names of the engine are none of its business: where the file declares one of them, its own is renamed
//! in the kernel, so that a driver that grows breaks no brush. The file's `brush` always is: to `apply`, as the
//! kernel calls it. A new name is as long as the old one where one is free, so that columns stay.

use std::collections::{BTreeMap, BTreeSet};

use naga::keywords::wgsl::{BUILTIN_IDENTIFIERS, RESERVED};

use super::{ALONE, BRUSH};
use crate::compile::resolve;
use crate::compile::text::{self, Token};
use crate::compile::tree::SourceTree;

/// What the user's function is called in its file.
pub(super) const FUNCTION: &str = "brush";
/// What it is called in the kernel.
const CALLED: &str = "apply";

/// A declaration outside all functions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Declared<'a> {
    /// `fn`, `const`, ...
    pub keyword: Token<'a>,
    /// The name that it declares.
    pub name: Token<'a>,
}

/// The declarations outside all functions, in order.
pub(super) fn declared<'a>(tokens: &'a [Token<'a>]) -> impl Iterator<Item = Declared<'a>> {
    let mut depth = 0_usize;
    tokens.iter().enumerate().filter_map(move |(index, &keyword)| {
        match keyword.text {
            "{" => depth += 1,
            "}" => depth = depth.saturating_sub(1),
            "alias" | "const" | "fn" | "override" | "struct" | "var" if depth == 0 => {
                let mut rest = tokens.get(index + 1..)?.iter();
                let mut name = rest.next()?;
                // var<private> a
                if name.text == "<" {
                    name = rest.find(|token| token.text == ">").and_then(|_| rest.next())?;
                }
                return Some(Declared { keyword, name: *name });
            }
            _ => {}
        }
        None
    })
}

/// All names that matter.
#[derive(Debug, Default)]
pub(super) struct Names {
    /// Declared in what a file may see.
    library: BTreeSet<String>,
    /// Declared in the rest of the kernel.
    engine: BTreeSet<String>,
    /// Declared by the file.
    file: BTreeSet<String>,
    /// Every word of the kernel and the file.
    words: BTreeSet<String>,
}

impl Names {
    /// The names of the engine, by the files of the kernel with the stand-in for the user's file.
    pub(super) fn of_engine(tree: &SourceTree) -> Self {
        let mut names = Self::default();
        // The files are the engine's own: what is wrong with them fails the build.
        let seen = resolve::flatten(tree, ALONE, &mut Vec::new()).sources;
        for (path, text) in tree.files() {
            let masked = text::without_comments(text).unwrap_or_default();
            let tokens = text::tokens(&masked);
            names.words.extend(tokens.iter().map(|token| token.text.to_owned()));
            let is_library = path != BRUSH && seen.iter().any(|seen| seen == path);
            let set = if is_library { &mut names.library } else { &mut names.engine };
            set.extend(declared(&tokens).map(|declared| declared.name.text.to_owned()));
        }
        names
    }

    /// Adds the names of the user's file.
    pub(super) fn add_file(&mut self, tokens: &[Token<'_>]) {
        self.words.extend(tokens.iter().map(|token| token.text.to_owned()));
        self.file.extend(declared(tokens).map(|declared| declared.name.text.to_owned()));
        if tokens.iter().any(|token| token.text == CALLED) {
            self.file.insert(CALLED.to_owned());
        }
    }

    /// Whether the library declares a name.
    pub(super) fn is_in_library(&self, name: &str) -> bool {
        self.library.contains(name)
    }

    /// A name that nobody has.
    fn free(&self, name: &str) -> String {
        let is_free = |candidate: &String| {
            !self.words.contains(candidate)
                && !candidate.starts_with("__")
                && !RESERVED.contains(&candidate.as_str())
                && !BUILTIN_IDENTIFIERS.contains(&candidate.as_str())
        };
        let mut start = name.to_owned();
        start.pop();
        let last = (b'_'..=b'_').chain(b'0'..=b'9').chain(b'a'..=b'z').chain(b'A'..=b'Z').map(char::from);
        let as_long = last.filter(|_| !start.is_empty()).map(|last| format!("{start}{last}"));
        let longer = (0_u64..).map(|number| format!("{name}_{number}"));
        as_long.chain(longer).find(is_free).unwrap_or_default()
    }
}

/// Old names of the user's file and new ones for the kernel.
#[derive(Debug, Default)]
pub(super) struct Renaming(BTreeMap<String, String>);

impl Renaming {
    pub(super) fn new(names: &Names) -> Self {
        let met: Vec<_> = names.file.intersection(&names.engine).filter(|name| *name != FUNCTION).collect();
        let mut renaming: BTreeMap<_, _> =
            met.into_iter().map(|name| (name.clone(), names.free(name))).collect();
        renaming.insert(FUNCTION.to_owned(), CALLED.to_owned());
        Self(renaming)
    }

    /// What a name of the file is called in the kernel.
    pub(super) fn new_name<'a>(&'a self, name: &'a str) -> &'a str {
        self.0.get(name).map_or(name, String::as_str)
    }

    /// The file as it stands in the kernel. Every word is renamed, local names and members too: that changes no meaning.
    pub(super) fn apply(&self, source: &str) -> String {
        let masked = text::without_comments(source).unwrap_or_default();
        let mut out = String::with_capacity(source.len());
        let mut copied = 0;
        for token in text::tokens(&masked) {
            if let Some(new_name) = self.0.get(token.text) {
                out.push_str(source.get(copied..token.offset).unwrap_or_default());
                out.push_str(new_name);
                copied = token.offset + token.text.len();
            }
        }
        out.push_str(source.get(copied..).unwrap_or_default());
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::custom::tests::{brush, compiled, errors_of};

    fn tree() -> SourceTree {
        let mut tree = SourceTree::new("shaders");
        for (path, text) in crate::CUSTOM_FILES {
            tree.insert(path, text).unwrap();
        }
        tree.insert(ALONE, super::super::ALONE_TEXT).unwrap();
        tree
    }

    #[test]
    fn declarations_are_those_outside_functions() {
        let text = "const A = 1; fn f() { const b = 2; var c = 3; } var<private> d: f32;\nstruct S { e: f32 }\nalias T = u32;";
        let tokens = text::tokens(text);
        let names: Vec<_> =
            declared(&tokens).map(|declared| (declared.keyword.text, declared.name.text)).collect();
        assert_eq!(names, [("const", "A"), ("fn", "f"), ("var", "d"), ("struct", "S"), ("alias", "T")]);
    }

    #[test]
    fn library_and_engine_are_told_apart() {
        let names = Names::of_engine(&tree());
        for name in ["BrushInput", "Parameters", "fbm", "hash", "lerp", "noise", "parameters"] {
            assert!(names.library.contains(name), "{name}");
        }
        for name in ["Brush", "Falloff", "apply", "brush", "custom", "heights", "main", "new_height"] {
            assert!(names.engine.contains(name) && !names.library.contains(name), "{name}");
        }
    }

    /// Renaming leaves no token alone, so no name of the engine may be a member of what a file sees, or a swizzle.
    #[test]
    fn members_of_the_library_are_no_names_of_the_engine() {
        let names = Names::of_engine(&tree());
        let members = [
            "height_m",
            "weight",
            "place_m",
            "sample",
            "radius_m",
            "spacing_m",
            "seed",
            "fract",
            "whole",
            "exp",
        ];
        for name in members {
            assert!(!names.engine.contains(name), "{name}");
        }
        for name in &names.engine {
            assert!(name.contains(|c: char| !"xyzwrgba".contains(c)), "{name} is a swizzle");
        }
    }

    #[test]
    fn names_of_the_engine_are_free_for_users() {
        for name in Names::of_engine(&tree()).engine {
            if name == FUNCTION {
                continue;
            }
            let helper = format!("fn {name}(x: f32) -> f32 {{ return x; }}\n");
            let text = format!("{helper}{}", brush(&format!("let y = {name}(at.weight);"), "y"));
            assert_eq!(errors_of(&text), [], "{name}");
        }
    }

    #[test]
    fn what_is_renamed_stays_in_its_column() {
        let text = "struct Tile { apply: f32 }\n\
                    fn heights(tile: Tile) -> f32 { let brush = tile.apply; return brush; }\n\
                    fn brush(at: BrushInput) -> f32 { return heights(Tile(at.weight)); }\n";
        let shader = compiled(text).shader;
        let expected = "struct Til_ { appl_: f32 }\n\
                        fn height_(tile: Til_) -> f32 { let apply = tile.appl_; return apply; }\n\
                        fn apply(at: BrushInput) -> f32 { return height_(Til_(at.weight)); }\n";
        assert!(shader.wgsl.contains(expected), "{}", shader.wgsl);
    }

    #[test]
    fn a_parameter_with_a_name_of_the_kernel() {
        let text = "// @param apply: f32 = 1 (0 .. 2) \"a\"\n// @param heights: f32 = 1 (0 .. 2) \"b\"\n\
                    fn brush(at: BrushInput) -> f32 { return parameters.apply + parameters.heights; }\n";
        let brush = compiled(text);
        assert_eq!(brush.parameters[0].name, "apply");
        assert!(brush.shader.wgsl.contains("return parameters.appl_ + parameters.heights;"));
        assert_eq!(brush.shader.find_struct("Parameters").unwrap().members[0].name, "appl_");
    }

    #[test]
    fn a_free_name_is_found_however_many_are_taken() {
        let mut names = Names::default();
        assert_eq!(names.free("ab"), "a_");
        assert_eq!(names.free("x"), "x_0");
        names.words.extend(["a_".to_owned(), "a0".to_owned()]);
        assert_eq!(names.free("ab"), "a1");
        assert_eq!(names.free("_b"), "_0");
        // `fn` and `if` are keywords.
        assert_ne!(names.free("fo"), "fn");
    }
}
