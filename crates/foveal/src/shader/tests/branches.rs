//! Branches that no shader may have.

use super::{every_source, parse};

/// What a value is made from.
#[derive(Clone, Copy, PartialEq)]
enum Origin {
    /// Literals, constants, overrides.
    Constant,
    /// At least one uniform, else constants.
    Uniform,
    /// Anything else.
    Varying,
}

fn origin(
    module: &naga::Module,
    function: &naga::Function,
    handle: naga::Handle<naga::Expression>,
) -> Origin {
    use naga::Expression as E;
    let all = |handles: &[naga::Handle<naga::Expression>]| {
        handles
            .iter()
            .map(|&h| origin(module, function, h))
            .fold(Origin::Constant, |a, b| match (a, b) {
                (Origin::Varying, _) | (_, Origin::Varying) => Origin::Varying,
                (Origin::Uniform, _) | (_, Origin::Uniform) => Origin::Uniform,
                _ => Origin::Constant,
            })
    };
    match &function.expressions[handle] {
        E::Literal(_) | E::Constant(_) | E::Override(_) | E::ZeroValue(_) => Origin::Constant,
        E::GlobalVariable(g)
            if module.global_variables[*g].space == naga::AddressSpace::Uniform =>
        {
            Origin::Uniform
        }
        E::Load { pointer } => all(&[*pointer]),
        E::AccessIndex { base, .. } => all(&[*base]),
        E::Access { base, index } => all(&[*base, *index]),
        E::Splat { value, .. } => all(&[*value]),
        E::Swizzle { vector, .. } => all(&[*vector]),
        E::Compose { components, .. } => all(components),
        E::Unary { expr, .. } | E::As { expr, .. } => all(&[*expr]),
        E::Binary { left, right, .. } => all(&[*left, *right]),
        E::Select {
            condition,
            accept,
            reject,
        } => all(&[*condition, *accept, *reject]),
        E::Relational { argument, .. } => all(&[*argument]),
        E::Math {
            arg,
            arg1,
            arg2,
            arg3,
            ..
        } => {
            let rest: Vec<_> = [*arg1, *arg2, *arg3]
                .into_iter()
                .flatten()
                .chain([*arg])
                .collect();
            all(&rest)
        }
        _ => Origin::Varying,
    }
}

/// A uniform alone, or a uniform against a local variable (a loop's counter), decides the
/// condition.
fn is_decided_by_uniforms(
    module: &naga::Module,
    function: &naga::Function,
    condition: naga::Handle<naga::Expression>,
) -> bool {
    use naga::Expression as E;
    let counter = |h| match &function.expressions[h] {
        E::Load { pointer } => matches!(function.expressions[*pointer], E::LocalVariable(_)),
        _ => false,
    };
    match &function.expressions[condition] {
        E::Binary { left, right, .. } => {
            let (l, r) = (
                origin(module, function, *left),
                origin(module, function, *right),
            );
            (l == Origin::Uniform && (r != Origin::Varying || counter(*right)))
                || (r == Origin::Uniform && (l != Origin::Varying || counter(*left)))
        }
        _ => origin(module, function, condition) == Origin::Uniform,
    }
}

fn visit(
    module: &naga::Module,
    function: &naga::Function,
    block: &naga::Block,
    found: &mut Vec<String>,
) {
    use naga::Statement as S;
    let mut check = |condition| {
        if is_decided_by_uniforms(module, function, condition) {
            found.push(function.name.clone().unwrap_or_default());
        }
    };
    for statement in block {
        match statement {
            S::If { condition, .. } => check(*condition),
            S::Switch { selector, .. } => check(*selector),
            S::Loop {
                break_if: Some(condition),
                ..
            } => check(*condition),
            _ => {}
        }
    }
    for statement in block {
        match statement {
            S::Block(inner) => visit(module, function, inner, found),
            S::If { accept, reject, .. } => {
                visit(module, function, accept, found);
                visit(module, function, reject, found);
            }
            S::Switch { cases, .. } => cases
                .iter()
                .for_each(|c| visit(module, function, &c.body, found)),
            S::Loop {
                body, continuing, ..
            } => {
                visit(module, function, body, found);
                visit(module, function, continuing, found);
            }
            _ => {}
        }
    }
}

fn branches_on_uniforms(module: &naga::Module) -> Vec<String> {
    let mut found = Vec::new();
    let functions = module.functions.iter().map(|(_, f)| f);
    for function in functions.chain(module.entry_points.iter().map(|e| &e.function)) {
        visit(module, function, &function.body, &mut found);
    }
    found
}

/// Mesa's lavapipe takes the values of such uniforms into the shader and compiles it again whenever
/// their buffer changes, which is every frame; the old one's memory is never given back (seen with
/// 22.3.6).
#[test]
fn no_branch_is_decided_by_uniforms_alone() {
    for (shader, source) in every_source() {
        let found = branches_on_uniforms(&parse(shader, &source));
        assert!(
            found.is_empty(),
            "{shader:?}: in {found:?}; use select, an override or a storage buffer"
        );
    }
    for bad in [
        "if u.x > 1u { o = 1u; }",
        "for (var i = 0u; i < u.y; i++) { o += i; }",
        "switch u.x { case 1u: { o = 2u; } default: {} }",
    ] {
        let source = format!(
            "@group(0) @binding(0) var<uniform> u: vec4u;
            @compute @workgroup_size(1) fn main() {{ var o = 0u; {bad} }}"
        );
        let module = naga::front::wgsl::parse_str(&source).expect("the example parses");
        assert!(
            !branches_on_uniforms(&module).is_empty(),
            "must be found: {bad}"
        );
    }
}
