//! `brushes` and `doctor`, help and the version.

use serde_json::Value;

use crate::program::{Folder, Ran};

const BRUSHES: [&str; 25] = [
    "raise",
    "lower",
    "ledge",
    "level",
    "set_height",
    "ramp",
    "roughen",
    "noise",
    "smooth",
    "sharpen",
    "smear",
    "grab",
    "clone",
    "erode_thermal",
    "erode_fluvial",
    "erode_droplets",
    "fill_pits",
    "terrace",
    "range_map",
    "stamp",
    "paint_mask",
    "erase_mask",
    "flow_mask",
    "rain_mask",
    "custom",
];

#[test]
fn brushes_lists_every_brush_with_ranges_and_the_ripple() {
    let folder = Folder::new();
    let text = folder.run("brushes").stdout;
    for brush in BRUSHES {
        assert!(text.contains(&format!("{brush}: ")), "{brush}");
    }
    for word in ["radius", "above 0 to 1e9 m", "50 m", "smooth, power, linear", "sigmoid", "%"] {
        assert!(text.contains(word), "{word}");
    }
    let report = folder.succeed("brushes");
    let titles: Vec<_> =
        report["brushes"].as_array().unwrap().iter().map(|one| one["title"].clone()).collect();
    assert_eq!(titles, BRUSHES);
    assert!(report["ripple"].as_array().unwrap().len() >= 7);
    let one = folder.succeed("brushes level");
    assert_eq!(one["brushes"].as_array().unwrap().len(), 1);
    assert_eq!(one["brushes"][0]["properties"]["only"]["enum"][0], "both");
    let eroding = folder.succeed("brushes erode_thermal");
    let layers = &eroding["brushes"][0]["properties"]["layers"];
    assert_eq!((&layers["type"], &layers["maxItems"]), (&"array".into(), &7.into()));
    assert_eq!(layers["items"]["properties"]["talus_angle"]["maximum"], 89.0);
    let nested = folder.succeed("brushes noise");
    let noise = &nested["brushes"][0]["properties"];
    assert_eq!(noise["distortion"]["properties"]["octaves"]["maximum"], 16);
    assert_eq!(
        noise["gate"]["properties"]["noise"]["properties"]["pattern"]["properties"]["octaves"]["default"],
        8
    );
}

#[test]
fn doctor_tells_what_works_with_a_driver() {
    let folder = Folder::new();
    let report = folder.succeed("doctor");
    assert_eq!(report["version"], env!("CARGO_PKG_VERSION"));
    assert!(report["num_threads"].as_u64().unwrap() > 0);
    assert!(!report["adapters"].as_array().unwrap().is_empty(), "GPU tests need an adapter: {report}");
    assert!(report["auto"]["works"].is_string());
    assert!(report["software"]["works"].is_string(), "{report}");
    assert!(report["import_endings"].as_array().unwrap().contains(&"hgt".into()));
    assert!(!report["export_endings"].as_array().unwrap().contains(&"zip".into()));
}

#[test]
fn without_a_driver_everything_works_and_doctor_says_what_to_install() {
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 300x300 --spacing 1");
    folder.write("recipe.json", r#"{"operations": [{"op": "fill", "brush": {"type": "raise"}}]}"#);
    let without = |line: &str| {
        let mut command = folder.command(line);
        // The loader of Vulkan finds no driver then; that there is one for OpenGL does not matter.
        for (name, value) in [("VK_DRIVER_FILES", "/none"), ("VK_ICD_FILENAMES", "/none")] {
            command.env(name, value);
        }
        Ran::from(command.output().unwrap())
    };
    let doctor = without("doctor --json");
    assert_eq!(doctor.code, Some(0), "{doctor:?}");
    let report: Value = serde_json::from_str(&doctor.stdout).unwrap();
    assert_eq!(report["adapters"], serde_json::json!([]));
    assert!(report["auto"]["works"].as_str().unwrap().starts_with("CPU"));
    let reason = report["software"]["fails"].as_str().unwrap();
    assert!(reason.contains("install"), "{reason}");
    if cfg!(target_os = "linux") {
        assert!(reason.contains("mesa-vulkan-drivers"), "{reason}");
    }
    assert!(without("doctor").stdout.contains("does not work"));

    let applied = without("apply t.orogeny recipe.json --adapter auto");
    assert!(applied.code == Some(0) && applied.stdout.contains("on CPU"), "{applied:?}");
    without("apply t.orogeny recipe.json --adapter software").assert_failed("no driver", &["install"]);
}

#[test]
fn help_and_version_are_answers() {
    let folder = Folder::new();
    for line in ["--help", "help", "apply --help", "--version"] {
        let ran = Ran::from(folder.command("").args(line.split(' ')).output().unwrap());
        assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), ""), "{line}");
        assert!(!ran.stdout.is_empty());
    }
    assert_eq!(
        Ran::from(std::process::Command::new(crate::program::binary()).output().unwrap()).code,
        Some(2)
    );
}
