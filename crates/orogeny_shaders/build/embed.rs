//! Compiled shaders as Rust source: the generated `SHADERS` table, and the files that a custom brush is compiled with.
//!
//! Every value is written in the order the compiler gives it, which is sorted, so the same folder always
//! generates the same bytes.

use std::fmt::{Result, Write};

use crate::compile::SourceTree;
use crate::shader::{Binding, BindingKind, LineRun, Member, Override, Shader, Struct};

/// The shader that runs the brushes of users.
const CUSTOM: &str = "custom/brush";

/// The text of `shaders.rs`, which `src/lib.rs` includes.
pub(crate) fn rust_source(
    tree: &SourceTree,
    shaders: &[Shader],
) -> std::result::Result<String, std::fmt::Error> {
    let mut out = String::new();
    writeln!(out, "/// Every shader of the `shaders/` folder, sorted by stem.")?;
    writeln!(out, "pub static SHADERS: &[Shader] = &[")?;
    for shader in shaders {
        write_shader(&mut out, shader)?;
    }
    writeln!(out, "];")?;

    writeln!(out, "/// The files of `{CUSTOM}` as they were written, by their paths below `shaders/`.")?;
    writeln!(out, "pub(crate) static CUSTOM_FILES: &[(&str, &str)] = &[")?;
    let custom = shaders.iter().find(|shader| shader.stem == CUSTOM);
    for path in custom.iter().flat_map(|shader| shader.sources.iter()) {
        writeln!(out, "({path:?}, {:?}),", tree.get(path).unwrap_or_default())?;
    }
    writeln!(out, "];")?;
    Ok(out)
}

fn write_shader(out: &mut String, shader: &Shader) -> Result {
    writeln!(out, "Shader {{")?;
    writeln!(out, "stem: Cow::Borrowed({:?}),", shader.stem)?;
    writeln!(out, "wgsl: Cow::Borrowed({:?}),", shader.wgsl)?;
    writeln!(out, "entry_point: Cow::Borrowed({:?}),", shader.entry_point)?;
    writeln!(out, "workgroup_size: {:?},", shader.workgroup_size)?;
    write_list(out, "bindings", &shader.bindings, write_binding)?;
    write_list(out, "structs", &shader.structs, write_struct)?;
    write_list(out, "overrides", &shader.overrides, write_override)?;
    write_list(out, "sources", &shader.sources, |out, source| write!(out, "Cow::Borrowed({source:?})"))?;
    write_list(out, "line_runs", &shader.line_runs, write_line_run)?;
    writeln!(out, "}},")
}

fn write_list<T>(
    out: &mut String,
    field: &str,
    items: &[T],
    write_item: impl Fn(&mut String, &T) -> Result,
) -> Result {
    write!(out, "{field}: Cow::Borrowed(&[")?;
    for item in items {
        write_item(out, item)?;
        writeln!(out, ",")?;
    }
    writeln!(out, "]),")
}

fn write_binding(out: &mut String, binding: &Binding) -> Result {
    let Binding { group, binding, name, kind, size_in_bytes } = binding;
    write!(out, "Binding {{ group: {group}, binding: {binding}, name: Cow::Borrowed({name:?}), kind: ")?;
    write_kind(out, *kind)?;
    write!(out, ", size_in_bytes: {size_in_bytes} }}")
}

fn write_kind(out: &mut String, kind: BindingKind) -> Result {
    write!(out, "BindingKind::")?;
    match kind {
        BindingKind::Texture { dimension, sample_type, multisampled } => write!(
            out,
            "Texture {{ dimension: TextureDimension::{dimension:?}, sample_type: SampleType::{sample_type:?}, \
             multisampled: {multisampled} }}"
        ),
        BindingKind::StorageTexture { dimension, format, access } => write!(
            out,
            "StorageTexture {{ dimension: TextureDimension::{dimension:?}, format: {format:?}, \
             access: TextureAccess::{access:?} }}"
        ),
        // Plain variants: their debug form is their Rust form.
        BindingKind::UniformBuffer | BindingKind::StorageBuffer { .. } | BindingKind::Sampler { .. } => {
            write!(out, "{kind:?}")
        }
    }
}

fn write_struct(out: &mut String, item: &Struct) -> Result {
    write!(out, "Struct {{ name: Cow::Borrowed({:?}), size: {}, ", item.name, item.size)?;
    write_list(out, "members", &item.members, write_member)?;
    write!(out, "}}")
}

fn write_member(out: &mut String, member: &Member) -> Result {
    let Member { name, offset, size, type_name } = member;
    write!(
        out,
        "Member {{ name: Cow::Borrowed({name:?}), offset: {offset}, size: {size}, \
         type_name: Cow::Borrowed({type_name:?}) }}"
    )
}

fn write_override(out: &mut String, item: &Override) -> Result {
    let Override { name, ty, default } = item;
    write!(out, "Override {{ name: Cow::Borrowed({name:?}), ty: ScalarType::{ty:?}, default: {default:?} }}")
}

fn write_line_run(out: &mut String, run: &LineRun) -> Result {
    write!(out, "{run:?}")
}
