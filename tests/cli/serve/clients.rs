//! What programs and people use the service by: the Python client, its example, the Blender add-on, the Godot script, the page in a browser,
//! and a program that tries every call by its description. What they need is made ready by `cargo xtask setup`, but for Godot.

use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use orogeny_tests::skip;
use serde_json::Value;

use super::Serving;
use crate::program::Folder;

/// The variable that names the Python in which the clients' packages are.
const PYTHON: &str = "OROGENY_TEST_PYTHON";

/// The variable that names a Godot 4.
const GODOT: &str = "OROGENY_TEST_GODOT";

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

/// A Godot of version 4: the one that the variable names, or one in the path.
fn godot() -> Option<PathBuf> {
    let named = std::env::var_os(GODOT).map(PathBuf::from);
    let candidates = named.map_or_else(|| vec!["godot4".into(), "godot".into()], |named| vec![named]);
    candidates.into_iter().find(|godot: &PathBuf| {
        let said = Command::new(godot).args(["--headless", "--version"]).output();
        said.is_ok_and(|said| said.status.success() && said.stdout.starts_with(b"4."))
    })
}

#[test]
fn godot_follows_and_paints() {
    const TOKEN: &str = "a-token-for-the-tests";
    let Some(godot) = godot() else {
        return skip("serve::godot", &format!("{GODOT} names no Godot 4, and none is in the path"));
    };
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 420x300 --spacing 2");
    folder.write("token", TOKEN);
    let mut serving = Some(Serving::start(&folder, "--token-file token"));
    let address = serving.as_ref().unwrap().address.clone();
    // Godot writes into the folder of a project, so it gets one of its own: as the README says, with the script in it.
    let (clients, project) = (root().join("clients/godot"), folder.path("project"));
    std::fs::create_dir(&project).unwrap();
    let ours = std::fs::read_dir(clients.join("tests")).unwrap().map(|entry| entry.unwrap().path());
    for file in ours.chain([clients.join("orogeny_live.gd")]).filter(|path| path.is_file()) {
        std::fs::copy(&file, project.join(file.file_name().unwrap())).unwrap();
    }
    let command = || {
        let mut command = Command::new(&godot);
        // Its settings are those of nobody.
        for variable in ["XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_CACHE_HOME"] {
            command.env(variable, folder.path("godot"));
        }
        command.args(["--headless", "--path"]).arg(&project);
        command
    };
    // The editor once: scripts are parsed, with warnings as errors, and their classes become known.
    let said = run(command().arg("--import"));
    assert!(!said.contains("ERROR"), "{said}");
    let mut child = command()
        .env("OROGENY_SERVICE_URL", format!("http://{address}"))
        .env("OROGENY_SERVICE_TOKEN", TOKEN)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut said = String::new();
    for line in BufReader::new(child.stdout.take().unwrap()).lines().map_while(Result::ok) {
        match line.as_str() {
            "stop the service" => serving.take().unwrap().stop(),
            "start the service" => {
                serving = Some(Serving::start_at(&folder, &address, "--token-file token"));
            }
            _ => {}
        }
        println!("{line}");
        said = line;
    }
    assert!(child.wait().unwrap().success(), "{said}");
    assert_eq!(said, "63 held, 0 problems");
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
