//! One system call in the words of strace.

use std::path::PathBuf;

/// A call that has returned.
pub struct Call<'a> {
    pub name: &'a str,
    pub arguments: Vec<&'a str>,
    pub result: &'a str,
}

impl<'a> Call<'a> {
    /// `NAME(ARGUMENTS) = RESULT`. With `-xx` no string holds a bracket or a comma.
    pub fn parse(text: &'a str) -> Result<Self, String> {
        let (name, rest) = text.split_once('(').ok_or("this is no call")?;
        if name.is_empty() || !name.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_') {
            return Err("this is no call".to_owned());
        }
        let ends = rest.match_indices(')').map(|(end, _)| rest.split_at(end));
        let (arguments, result) = ends
            .filter_map(|(arguments, after)| Some((arguments, after[1..].trim_start().strip_prefix("= ")?)))
            .next()
            .ok_or("the call has no result")?;
        Ok(Self { name, arguments: arguments.split(',').map(str::trim).collect(), result: result.trim() })
    }

    pub fn argument(&self, index: usize) -> Result<&'a str, String> {
        self.arguments.get(index).copied().ok_or_else(|| format!("there is no argument {index}"))
    }

    pub fn has_failed(&self) -> bool {
        self.result.starts_with('-') || self.result == "?"
    }

    pub fn returned(&self) -> Result<usize, String> {
        number(self.result.split(' ').next().unwrap_or_default())
    }

    /// What reached the file, which may be less than was given.
    pub fn written_bytes(&self) -> Result<Vec<u8>, String> {
        let mut bytes = bytes_of_string(self.argument(1)?)?;
        let num_given = number(self.argument(2)?)?;
        if bytes.len() != num_given {
            return Err(format!("{} bytes of {num_given} are in the log", bytes.len()));
        }
        bytes.truncate(self.returned()?);
        Ok(bytes)
    }
}

pub fn number(text: &str) -> Result<usize, String> {
    text.parse().map_err(|_| format!("`{text}` is no number"))
}

fn hexadecimal(text: &str) -> Result<Vec<u8>, String> {
    let not_hexadecimal = || format!("`{text}` is not in hexadecimal");
    let digits = text.split("\\x").skip(1);
    let bytes: Option<Vec<u8>> =
        digits.map(|pair| (pair.len() == 2).then(|| u8::from_str_radix(pair, 16).ok())?).collect();
    let bytes = bytes.ok_or_else(not_hexadecimal)?;
    if bytes.len() * 4 == text.len() { Ok(bytes) } else { Err(not_hexadecimal()) }
}

fn bytes_of_string(text: &str) -> Result<Vec<u8>, String> {
    // Three points behind the quotes say that something was left out.
    let inner = text.strip_prefix('"').and_then(|text| text.strip_suffix('"'));
    hexadecimal(inner.ok_or("a string is not whole")?)
}

pub fn path_of_string(text: &str) -> Result<Option<PathBuf>, String> {
    Ok(Some(PathBuf::from(String::from_utf8_lossy(&bytes_of_string(text)?).into_owned())))
}

/// `3<PATH>`: the path of an open file that has one. One that was removed (`3<PATH>(deleted)`) has none any more.
pub fn path_of_descriptor(text: &str) -> Result<Option<PathBuf>, String> {
    let Some((_, rest)) = text.split_once('<') else { return Ok(None) };
    let Some((path, "")) = rest.rsplit_once('>') else { return Ok(None) };
    if !path.starts_with("\\x2f") {
        return Ok(None);
    }
    let path = String::from_utf8_lossy(&hexadecimal(path)?).into_owned();
    Ok((!path.ends_with(" (deleted)")).then(|| PathBuf::from(path)))
}
