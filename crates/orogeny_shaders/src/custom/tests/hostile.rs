//! Texts that nobody means well with: none panics, overflows the stack or takes long.

use std::thread;
use std::time::{Duration, Instant};

use super::*;

/// For one text, on a slow machine with other tests beside it.
const LONG: Duration = Duration::from_secs(10);

/// The outcome, which is one of those that are meant, within the time that is meant.
fn outcome(text: &str) -> Result<CustomBrush> {
    let start = Instant::now();
    let outcome = compile_custom(text, "test.wgsl");
    assert!(
        start.elapsed() < LONG,
        "{:?} for {}",
        start.elapsed(),
        text.chars().take(200).collect::<String>()
    );
    match &outcome {
        Ok(_) => {}
        Err(err @ Error::BrokenBrush { diagnostics, .. }) => {
            assert!((1..=100).contains(&diagnostics.len()));
            let longest = err.to_string().lines().map(|line| line.chars().count()).max();
            assert!(longest < Some(4000), "a message is too long to read: {longest:?}");
        }
        Err(err) => panic!("{err} for {text}"),
    }
    outcome
}

/// As deep as the rules allow, in all ways at once: blocks, `else if`, and an expression of one sign after another.
fn deepest(expression: &str) -> String {
    let chain = "else if at.weight > 1.0 { }\n".repeat(198);
    let last = format!("else if {expression} {{ }}");
    let blocks = 30;
    let statements =
        format!("{}\nif at.weight > 2.0 {{ }}\n{chain}{last}\n{}", "{ ".repeat(blocks), "} ".repeat(blocks));
    brush(&statements, "1.0")
}

/// Expressions just within the limit.
fn deep_expressions() -> Vec<String> {
    let spread = |part: &str, times: usize| {
        (0..times).map(|k| format!("{part}{}", if k % 20 == 19 { "\n" } else { "" })).collect::<String>()
    };
    vec![
        format!("1{} > 2", spread(" + 1", 200)),
        format!("at.weight{} > 2.0", spread(" + at.weight", 150)),
        format!("{}true", spread("!", 700)),
        format!("{}at.weight > 2.0", spread("- ", 700)),
        format!("vec2<f32>(){}.x > 2.0", spread(".xy", 250)),
        format!("{}1{} > 2", "abs(".repeat(30), ")".repeat(30)),
        format!("{}1{} > 2", "(1 + ".repeat(30), ")".repeat(30)),
        format!("true{}", spread(" && at.weight > 1.0", 100)),
    ]
}

#[test]
fn the_deepest_text_takes_a_tenth_of_the_stack() {
    for expression in deep_expressions() {
        let text = deepest(&expression);
        let thread = thread::Builder::new().stack_size(STACK_IN_BYTES / 10);
        // A stack overflow ends the test's process.
        let outcome = thread.spawn(move || compile(&text, "test.wgsl")).unwrap().join().unwrap();
        if let Err(err) = outcome {
            panic!("{}: {err}", expression.chars().take(40).collect::<String>());
        }
    }
}

#[test]
fn nesting_without_end() {
    for part in [
        "(",
        ")",
        "[",
        "]",
        "{",
        "}",
        "<",
        ">",
        "/*",
        "//",
        "*/",
        "-",
        "!",
        "~",
        "*",
        "&",
        "a.",
        "a[",
        "f(",
        "if ",
        "else if a {} ",
        "loop {",
        "for (;;) {",
        "while a {",
        "switch a { default: {",
        "array<",
        "vec2<",
        "ptr<function, ",
        "1+",
        "1,",
        "@",
        "#\n",
        "fn f() {",
        "struct A {",
        "a:",
        ";",
        "\"",
        "0x",
        "1e",
        "\u{0}",
        "\u{2028}",
        "é",
        "𝕏",
        "_",
        "__",
        "\t",
        "\n",
    ] {
        for times in [63, 1000, 65_536 / part.len()] {
            let _ = outcome(&part.repeat(times));
            let _ = outcome(&brush(&part.repeat(times), "1.0"));
            let _ = outcome(&format!("const A = {}1;\n{}", part.repeat(times), brush("", "1.0")));
        }
    }
}

#[test]
fn chains_of_declarations() {
    let chain = |line: fn(usize) -> String| (1..250).map(line).collect::<String>();
    for declarations in [
        format!("const a0 = 1;\n{}", chain(|k| format!("const a{k} = a{} + a{};\n", k - 1, k - 1))),
        format!("alias a0 = f32;\n{}", chain(|k| format!("alias a{k} = array<a{}, 2>;\n", k - 1))),
        format!(
            "struct a0 {{ x: f32 }}\n{}",
            chain(|k| format!("struct a{k} {{ x: a{0}, y: a{0} }}\n", k - 1))
        ),
        format!("fn a0() {{}}\n{}", chain(|k| format!("fn a{k}() {{ a{0}(); a{0}(); }}\n", k - 1))),
        chain(|k| format!("fn a{k}() {{ a{}(); }}\n", (k + 1) % 250)),
        chain(|k| format!("const a{k} = a{};\n", k + 1)),
        format!(
            "const a0 = array(1.0, 2.0);\n{}",
            chain(|k| format!("const a{k} = array(a{0}, a{0});\n", k - 1))
        ),
    ] {
        let _ = outcome(&format!("{declarations}{}", brush("", "1.0")));
    }
}

#[test]
fn loops_and_values_without_end() {
    for statements in [
        "for (var i = 0; i < 2147483647; i++) { for (var j = 0; j < 2147483647; j++) { } }",
        "for (var i = 0u; i < 4294967295u; i++) { }",
        "var a: array<array<array<f32, 1000>, 1000>, 1000>;",
        "let a = array<f32, 268435455>();",
        "let a = array<f32, 4294967295>();",
        "let a = array<f32, 0>();",
        "const a = array<i32, 65536>(); const b = a[65535]; const c = a[65536];",
        "let a = 1u << 32u; let b = 1 / 0; let c = -2147483648 / -1; let d = 2147483647 + 1;",
        "const_assert 1 / 0 == 1;",
        "const_assert false;",
        "const_assert at.weight > 1.0;",
        "const a = f32(1e38) * 1e38; let b = 1e400; let c = 0x1p9999; let d = 99999999999999999999;",
        "switch at.sample.x { case 1, 1: { } default: { } default: { } }",
        "let a = at.place_m[2]; let b = at.place_m[-1]; let c = at.place_m[4294967296];",
        "let a = mat4x4<f32>() * mat4x4<f32>() * vec4<f32>(); let b = determinant(mat4x4<f32>());",
    ] {
        let _ = outcome(&brush(statements, "1.0"));
    }
}

/// Bytes of the examples changed, removed, doubled, and pieces of them put elsewhere, by a seeded generator.
#[test]
fn two_thousand_mutations() {
    let examples: Vec<&str> = EXAMPLES.iter().map(|(_, text)| *text).collect();
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut random = |n: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 33) as usize % n.max(1)
    };
    let start = Instant::now();
    let mut num_compiled = 0;
    for _ in 0..2000 {
        let mut bytes = examples[random(examples.len())].as_bytes().to_vec();
        for _ in 0..=random(4) {
            let (at, other) = (random(bytes.len()), random(bytes.len()));
            match random(6) {
                0 => bytes[at] = random(256) as u8,
                1 => bytes[at] = b"(){}[]<>;,.:=+-*/&|!@#0 \n\""[random(26)],
                2 => drop(bytes.remove(at)),
                3 => bytes.insert(at, bytes[other]),
                4 => bytes.swap(at, other),
                _ => {
                    let piece = bytes[at..(at + random(40)).min(bytes.len())].to_vec();
                    bytes.splice(other..other, piece);
                }
            }
        }
        num_compiled += usize::from(outcome(&String::from_utf8_lossy(&bytes)).is_ok());
    }
    assert!((50..1950).contains(&num_compiled), "{num_compiled} of 2000 compiled");
    assert!(start.elapsed() < 10 * LONG, "{:?}", start.elapsed());
}
