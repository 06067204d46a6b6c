//! What the host must know of a module: bindings, memory layouts, overrides, the workgroup.
//!
//! The Rust mirrors of uniforms are tested against this, and pipelines are laid out by it, so what the
//! tables cannot say (an override that depends on another one, a workgroup sized by an override) is an error here
//! and never a guess.

use std::borrow::Cow;

use naga::common::wgsl::{ToWgsl, TypeContext};
use naga::proc::GlobalCtx;
use naga::{
    AddressSpace, Expression, Handle, ImageClass, ImageDimension, Literal, ScalarKind, StorageAccess,
    TypeInner,
};

use super::diagnostic::Diagnostic;
use super::resolve::Flattened;
use super::tree::SourceTree;
use super::validate::diagnostic_at;
use crate::shader::{
    Binding, BindingKind, Member, Override, SampleType, ScalarType, Shader, Struct, TextureAccess,
    TextureDimension,
};

/// The embedded form of a validated module; `None` if the module has what the tables cannot say.
pub(crate) fn shader(
    tree: &SourceTree,
    path: &str,
    flattened: &Flattened,
    module: &naga::Module,
    diagnostics: &mut Vec<Diagnostic>,
) -> Option<Shader> {
    let num_before = diagnostics.len();
    // Zero or several entry points are the lint's to report.
    let [entry_point] = module.entry_points.as_slice() else {
        return None;
    };
    let mut report = |span, message: &str| diagnostics.push(diagnostic_at(tree, flattened, span, message));
    if entry_point.workgroup_size_overrides.is_some() {
        report(naga::Span::default(), "the workgroup size depends on an override; write it as numbers");
    }

    let mut bindings = Vec::new();
    for (handle, variable) in module.global_variables.iter() {
        match reflect_binding(module, variable) {
            Ok(binding) => bindings.extend(binding),
            Err(message) => report(module.global_variables.get_span(handle), message),
        }
    }
    let mut overrides = Vec::new();
    for (handle, item) in module.overrides.iter() {
        match reflect_override(module, item) {
            Ok(item) => overrides.push(item),
            Err(message) => report(module.overrides.get_span(handle), message),
        }
    }
    if diagnostics.len() > num_before {
        return None;
    }

    bindings.sort_by_key(|binding| (binding.group, binding.binding));
    overrides.sort_by(|a, b| a.name.cmp(&b.name));
    Some(Shader {
        stem: Cow::Owned(path.trim_end_matches(".wgsl").to_owned()),
        wgsl: Cow::Owned(flattened.wgsl.clone()),
        entry_point: Cow::Owned(entry_point.name.clone()),
        workgroup_size: entry_point.workgroup_size,
        bindings: bindings.into(),
        structs: reflect_structs(module).into(),
        overrides: overrides.into(),
        sources: flattened.sources.iter().cloned().map(Cow::Owned).collect(),
        line_runs: flattened.line_runs.clone().into(),
    })
}

fn reflect_binding(
    module: &naga::Module,
    variable: &naga::GlobalVariable,
) -> Result<Option<Binding>, &'static str> {
    let Some(resource) = variable.binding else {
        return Ok(None);
    };
    let kind = binding_kind(variable.space, module.types.get_handle(variable.ty).map(|ty| &ty.inner).ok());
    Ok(Some(Binding {
        group: resource.group,
        binding: resource.binding,
        name: Cow::Owned(variable.name.clone().unwrap_or_default()),
        kind: kind.ok_or("a binding of a kind that this engine does not use")?,
        size_in_bytes: match variable.space {
            AddressSpace::Handle => 0,
            _ => size(module.to_ctx(), variable.ty).into(),
        },
    }))
}

fn binding_kind(space: AddressSpace, ty: Option<&TypeInner>) -> Option<BindingKind> {
    match (space, ty?) {
        (AddressSpace::Uniform, _) => Some(BindingKind::UniformBuffer),
        (AddressSpace::Storage { access }, _) => {
            Some(BindingKind::StorageBuffer { writable: access.contains(StorageAccess::STORE) })
        }
        (AddressSpace::Handle, &TypeInner::Sampler { comparison }) => {
            Some(BindingKind::Sampler { comparison })
        }
        (AddressSpace::Handle, &TypeInner::Image { dim, arrayed, class }) => {
            texture_kind(texture_dimension(dim, arrayed)?, class)
        }
        _ => None,
    }
}

fn texture_kind(dimension: TextureDimension, class: ImageClass) -> Option<BindingKind> {
    match class {
        ImageClass::Sampled { kind, multi: multisampled } => {
            let sample_type = match kind {
                ScalarKind::Float => SampleType::Float,
                ScalarKind::Sint => SampleType::Sint,
                ScalarKind::Uint => SampleType::Uint,
                ScalarKind::Bool | ScalarKind::AbstractInt | ScalarKind::AbstractFloat => return None,
            };
            Some(BindingKind::Texture { dimension, sample_type, multisampled })
        }
        ImageClass::Depth { multi: multisampled } => {
            Some(BindingKind::Texture { dimension, sample_type: SampleType::Depth, multisampled })
        }
        ImageClass::Storage { format, access } => {
            let access = match (access.contains(StorageAccess::LOAD), access.contains(StorageAccess::STORE)) {
                (true, true) => TextureAccess::ReadWrite,
                (true, false) => TextureAccess::Read,
                (false, true) => TextureAccess::Write,
                (false, false) => return None,
            };
            Some(BindingKind::StorageTexture { dimension, format: format.to_wgsl(), access })
        }
        ImageClass::External => None,
    }
}

fn texture_dimension(dimension: ImageDimension, arrayed: bool) -> Option<TextureDimension> {
    match (dimension, arrayed) {
        (ImageDimension::D1, false) => Some(TextureDimension::D1),
        (ImageDimension::D2, false) => Some(TextureDimension::D2),
        (ImageDimension::D2, true) => Some(TextureDimension::D2Array),
        (ImageDimension::D3, false) => Some(TextureDimension::D3),
        (ImageDimension::Cube, false) => Some(TextureDimension::Cube),
        _ => None,
    }
}

fn reflect_structs(module: &naga::Module) -> Vec<Struct> {
    let ctx = module.to_ctx();
    let mut structs: Vec<Struct> = module
        .types
        .iter()
        .filter_map(|(_, ty)| match (&ty.name, &ty.inner) {
            // Two underscores: a result type that WGSL predeclares, which cannot be written in source.
            (Some(name), TypeInner::Struct { members, span }) if !name.starts_with("__") => Some(Struct {
                name: Cow::Owned(name.clone()),
                size: *span,
                members: members.iter().map(|member| reflect_member(ctx, member)).collect(),
            }),
            _ => None,
        })
        .collect();
    structs.sort_by(|a, b| a.name.cmp(&b.name));
    structs
}

fn reflect_member(ctx: GlobalCtx<'_>, member: &naga::StructMember) -> Member {
    let mut type_name = String::new();
    // Writing to a string does not fail.
    let _ = ctx.write_type(member.ty, &mut type_name);
    Member {
        name: Cow::Owned(member.name.clone().unwrap_or_default()),
        offset: member.offset,
        size: size(ctx, member.ty),
        type_name: Cow::Owned(type_name),
    }
}

/// The size in bytes of a type that validation has accepted: its size is known and fits.
fn size(ctx: GlobalCtx<'_>, ty: Handle<naga::Type>) -> u32 {
    ctx.types.get_handle(ty).ok().and_then(|ty| ty.inner.try_size(ctx)).unwrap_or_default()
}

fn reflect_override(module: &naga::Module, item: &naga::Override) -> Result<Override, &'static str> {
    if item.id.is_some() {
        return Err("an override with @id; leave it out, overrides are set by their names");
    }
    let ty = match module.types.get_handle(item.ty).map(|ty| &ty.inner) {
        Ok(TypeInner::Scalar(scalar)) => match scalar.kind {
            ScalarKind::Bool => ScalarType::Bool,
            ScalarKind::Float => ScalarType::F32,
            ScalarKind::Sint => ScalarType::I32,
            ScalarKind::Uint => ScalarType::U32,
            ScalarKind::AbstractInt | ScalarKind::AbstractFloat => return Err("an override with no type"),
        },
        _ => return Err("an override that is not a scalar"),
    };
    let default = item.init.map(|init| literal_value(module, init)).transpose()?;
    Ok(Override { name: Cow::Owned(item.name.clone().unwrap_or_default()), ty, default })
}

fn literal_value(module: &naga::Module, expression: Handle<Expression>) -> Result<f64, &'static str> {
    match module.global_expressions.try_get(expression) {
        Ok(&Expression::Literal(Literal::F32(value))) => Ok(value.into()),
        Ok(&Expression::Literal(Literal::I32(value))) => Ok(value.into()),
        Ok(&Expression::Literal(Literal::U32(value))) => Ok(value.into()),
        Ok(&Expression::Literal(Literal::Bool(value))) => Ok(u8::from(value).into()),
        _ => Err("the default of an override is not a number; write it as one, or give it none"),
    }
}
