//! A compiled shader: the flattened text, what it binds, and where each of its lines came from.
//!
//! Texts and lists are `Cow`s, so that an embedded shader (borrowed from the binary) and one compiled at run time
//! (owned) are the same type to whoever makes pipelines from them.

use std::borrow::Cow;

/// One entry-point file with everything that it includes, parsed and validated.
#[derive(Clone, Debug, PartialEq)]
pub struct Shader {
    /// The path of the entry-point file below `shaders/`, without the extension: `brush/raise`.
    pub stem: Cow<'static, str>,
    /// The text with its includes resolved, ready for the driver.
    pub wgsl: Cow<'static, str>,
    /// The entry point's name.
    pub entry_point: Cow<'static, str>,
    /// Invocations a workgroup along x, y and z; `[0, 0, 0]` for a stage that has no workgroups.
    pub workgroup_size: [u32; 3],
    /// What the module binds, sorted by group, then binding.
    pub bindings: Cow<'static, [Binding]>,
    /// The structs that the module declares, sorted by name.
    pub structs: Cow<'static, [Struct]>,
    /// The pipeline-overridable constants, sorted by name.
    pub overrides: Cow<'static, [Override]>,
    /// The files that went in, as paths below `shaders/`, in the order of their first line.
    pub sources: Cow<'static, [Cow<'static, str>]>,
    /// Where the lines of `wgsl` came from, sorted and without gaps.
    pub line_runs: Cow<'static, [LineRun]>,
}

impl Shader {
    /// Where line `flattened_line` (from 1) of [`Shader::wgsl`] was written; `None` beyond the text.
    ///
    /// Lines are copied whole, so a column is the same in both.
    pub fn original_location(&self, flattened_line: u32) -> Option<SourceLine<'_>> {
        let (source, line) = locate(&self.line_runs, flattened_line)?;
        Some(SourceLine { file: self.sources.get(source as usize)?, line })
    }

    /// The struct of the given name, if the module declares one.
    pub fn find_struct(&self, name: &str) -> Option<&Struct> {
        self.structs.iter().find(|item| item.name == name)
    }
}

/// The source index and line of a flattened line (from 1).
pub(crate) fn locate(line_runs: &[LineRun], flattened_line: u32) -> Option<(u32, u32)> {
    let next = line_runs.partition_point(|run| run.flattened_line <= flattened_line);
    let run = line_runs.get(next.checked_sub(1)?)?;
    let lines_into_run = flattened_line - run.flattened_line;
    (lines_into_run < run.num_lines).then_some((run.source, run.source_line + lines_into_run))
}

/// A line of a file below `shaders/`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SourceLine<'a> {
    /// The path below `shaders/`: `lib/falloff.wgsl`.
    pub file: &'a str,
    /// The line, from 1.
    pub line: u32,
}

/// Successive flattened lines that are successive lines of one file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LineRun {
    /// The first of them in the flattened text, from 1.
    pub flattened_line: u32,
    /// How many.
    pub num_lines: u32,
    /// The file: an index into [`Shader::sources`].
    pub source: u32,
    /// The first of them in the file, from 1.
    pub source_line: u32,
}

/// A resource that the module binds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Binding {
    /// The bind group's index.
    pub group: u32,
    /// The index in the group.
    pub binding: u32,
    /// The variable's name.
    pub name: Cow<'static, str>,
    /// What is bound.
    pub kind: BindingKind,
    /// The least size of the buffer in bytes: for a runtime-sized array that of one element, for a texture or
    /// sampler 0.
    pub size_in_bytes: u64,
}

/// What kind of resource a binding takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BindingKind {
    /// A uniform buffer.
    UniformBuffer,
    /// A storage buffer.
    StorageBuffer {
        /// Whether the shader may write it.
        writable: bool,
    },
    /// A texture that is loaded from or sampled.
    Texture {
        /// Its dimension.
        dimension: TextureDimension,
        /// What a texel reads as.
        sample_type: SampleType,
        /// Whether it has several samples a texel.
        multisampled: bool,
    },
    /// A texture that is read or written texel by texel.
    StorageTexture {
        /// Its dimension.
        dimension: TextureDimension,
        /// The texel format as WGSL names it: `r32float`.
        format: &'static str,
        /// How it may be used.
        access: TextureAccess,
    },
    /// A sampler.
    Sampler {
        /// Whether it compares with a reference depth.
        comparison: bool,
    },
}

/// The dimension of a bound texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextureDimension {
    /// `texture_1d`
    D1,
    /// `texture_2d`
    D2,
    /// `texture_2d_array`
    D2Array,
    /// `texture_3d`
    D3,
    /// `texture_cube`
    Cube,
}

/// What a texel of a bound texture reads as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SampleType {
    /// `f32`
    Float,
    /// `i32`
    Sint,
    /// `u32`
    Uint,
    /// A depth texture.
    Depth,
}

/// How a storage texture may be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextureAccess {
    /// `read`
    Read,
    /// `write`
    Write,
    /// `read_write`
    ReadWrite,
}

/// A struct of the module with its memory layout.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Struct {
    /// Its name.
    pub name: Cow<'static, str>,
    /// Its size in bytes with all padding; a runtime-sized array at its end counts one element.
    pub size: u32,
    /// Its members in the order of their offsets.
    pub members: Cow<'static, [Member]>,
}

/// A member of a [`Struct`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Member {
    /// Its name.
    pub name: Cow<'static, str>,
    /// Its offset in bytes.
    pub offset: u32,
    /// Its size in bytes, without the padding after it.
    pub size: u32,
    /// Its type as WGSL writes it: `vec3<f32>`, `array<Instance>`.
    pub type_name: Cow<'static, str>,
}

/// A pipeline-overridable constant.
#[derive(Clone, Debug, PartialEq)]
pub struct Override {
    /// Its name, by which a pipeline sets it.
    pub name: Cow<'static, str>,
    /// Its type.
    pub ty: ScalarType,
    /// Its value where the pipeline gives none; `None`: every pipeline must give one. A `bool` is 0 or 1.
    pub default: Option<f64>,
}

/// The type of an [`Override`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScalarType {
    /// `bool`
    Bool,
    /// `f32`
    F32,
    /// `i32`
    I32,
    /// `u32`
    U32,
}
