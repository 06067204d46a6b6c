//! Lists the files of the page, so that they come with the program.

use std::fmt::Write as _;
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = Path::new(&std::env::var("CARGO_MANIFEST_DIR")?).join("page");
    println!("cargo::rerun-if-changed={}", folder.display());
    let mut names = Vec::new();
    for entry in std::fs::read_dir(&folder)? {
        let entry = entry?;
        if entry.file_type()?.is_file() {
            println!("cargo::rerun-if-changed={}", entry.path().display());
            names.push(entry.file_name().into_string().map_err(|name| format!("{name:?} is no UTF-8"))?);
        }
    }
    names.sort();
    let mut list = "/// Names and contents.\nconst FILES: &[(&str, &[u8])] = &[\n".to_owned();
    for name in &names {
        writeln!(list, "    ({name:?}, include_bytes!({:?})),", folder.join(name))?;
    }
    list.push_str("];\n");
    std::fs::write(Path::new(&std::env::var("OUT_DIR")?).join("page_files.rs"), list)?;
    Ok(())
}
