//! What programs and people use the service by: the Python client, its example, the Blender add-on, the page in a browser, and a program that
//! tries every call by its description. What they need is made ready by `cargo xtask setup`.

use std::path::{Path, PathBuf};
use std::process::Command;

use orogeny_tests::skip;
use serde_json::Value;

use super::Serving;
use crate::program::Folder;

/// The variable that names the Python in which the clients' packages are.
const PYTHON: &str = "OROGENY_TEST_PYTHON";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// The Python that has a module; a skip that is counted where there is none.
fn python(test: &str, module: &str) -> Option<PathBuf> {
    let python = std::env::var_os(PYTHON).map(PathBuf::from);
    let has_module = |python: &Path| {
        Command::new(python)
            .args(["-c", &format!("import {module}")])
            .output()
            .is_ok_and(|out| out.status.success())
    };
    let found = python.filter(|python| has_module(python));
    if found.is_none() {
        skip(test, &format!("{PYTHON} names no Python that has `{module}`; `cargo xtask setup` makes one"));
    }
    found
}

fn serve(size: &str) -> (Folder, Serving) {
    let folder = Folder::new();
    folder.succeed(&format!("new t.orogeny --size {size} --spacing 2"));
    let serving = Serving::start(&folder, "");
    (folder, serving)
}

fn run(command: &mut Command) -> String {
    let output = command.output().unwrap();
    let said =
        format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{command:?} ended with {}:\n{said}", output.status);
    said
}

#[test]
fn the_python_client_and_its_example_work_against_it() {
    let Some(python) = python("serve::python", "pytest, httpx, websockets, numpy, hypothesis, aiohttp")
    else {
        return;
    };
    let (folder, serving) = serve("1024x1024");
    let tests = ["-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:unraisableexception"];
    let said = run(Command::new(&python)
        .args(tests)
        .current_dir(root().join("clients/python"))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("HYPOTHESIS_STORAGE_DIRECTORY", folder.path("hypothesis"))
        .env("OROGENY_SERVICE_URL", serving.url()));
    let last = said.lines().rev().find(|line| line.contains("passed")).unwrap_or_default();
    let num_passed =
        last.split(" passed").next().and_then(|start| start.rsplit(' ').next()?.parse::<u32>().ok());
    assert!(num_passed.is_some_and(|passed| passed > 70), "{said}");
    let before = folder.succeed("log t.orogeny")["entries"].as_array().unwrap().len();
    let said = run(Command::new(&python)
        .arg("examples/road.py")
        .arg(serving.url())
        .current_dir(root().join("clients/python"))
        .env("PYTHONPATH", "src")
        .env("PYTHONDONTWRITEBYTECODE", "1"));
    println!("{said}");
    let after = folder.succeed("log t.orogeny")["entries"].as_array().unwrap().len();
    assert!(after > before, "the example did nothing: {said}");
}

#[test]
fn blender_shows_and_paints_what_is_there() {
    let Some(python) = python("serve::blender", "bpy, pytest") else { return };
    let (_folder, serving) = serve("1024x1024");
    let said = run(Command::new(&python)
        .args(["-m", "pytest", "-q", "-p", "no:cacheprovider"])
        .current_dir(root().join("clients/blender"))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("OROGENY_SERVICE_URL", serving.url()));
    assert!(said.contains("passed"), "{said}");
}

#[test]
fn people_paint_and_undo_in_two_browsers() {
    let Some(python) = python("serve::browser", "playwright") else { return };
    let chromium = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"]
        .into_iter()
        .find(|path| Path::new(path).exists());
    let Some(chromium) = chromium else {
        return skip("serve::browser", "there is no Chromium; `cargo xtask setup` installs it");
    };
    // Playwright for Python brings a Node.js and the library for it along.
    let driver = run(Command::new(&python).args(["-c", "import playwright; print(playwright.__path__[0])"]));
    let driver = Path::new(driver.trim()).join("driver");
    let (folder, serving) = serve("1024x1024");
    let said = run(Command::new(driver.join("node"))
        .arg(root().join("tests/cli/serve/drive.mjs"))
        .arg(format!("{}/", serving.url()))
        .arg(folder.path("pictures"))
        .env("PLAYWRIGHT_CORE", driver.join("package/index.mjs"))
        .env("DRIVE_WAIT_MS", "60000")
        .env("CHROMIUM", chromium));
    assert!(said.contains("18 held, 0 problems") || said.contains("17 held, 0 problems"), "{said}");
    let pictures = std::fs::read_dir(folder.path("pictures")).unwrap().count();
    assert!(pictures >= 8, "{pictures} pictures");
}

#[test]
fn every_call_answers_as_its_description_says_whatever_is_asked() {
    let Some(python) = python("serve::schema", "schemathesis") else { return };
    let (folder, serving) = serve("300x300");
    let num_examples = if std::env::var_os("OROGENY_TEST_LONG").is_some() { "500" } else { "25" };
    let said = run(Command::new(&python)
        .args(["-m", "schemathesis.cli", "run", &format!("{}/openapi.json", serving.url())])
        .args(["--max-examples", num_examples, "--seed", "7", "--exclude-path", "/v1/terrains/{name}/live"])
        .args([
            "--checks",
            "not_a_server_error,status_code_conformance,content_type_conformance,response_schema_conformance",
        ])
        .args(["--request-timeout", "60", "--generation-database", "none", "--no-color"])
        .current_dir(folder.path("")));
    println!("{said}");
    let report = folder.succeed("check t.orogeny");
    assert_eq!(report["problems"].as_array().map(Vec::len), Some(0), "{report}");
    let log: Value = folder.succeed("log t.orogeny");
    println!("{} entries", log["entries"].as_array().unwrap().len());
}
