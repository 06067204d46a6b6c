//! Pages that had to make room, such as the weights of a wash: a temporary file, so that a stroke over any number of pages keeps to
//! the budget.

use std::collections::HashMap;
use std::fs::File;
use std::io::{Read as _, Seek as _, SeekFrom, Write as _};

use orogeny_field::{Page, PageKey, PageLayout};

use crate::{Error, Result};

/// Pages put aside for the length of one stroke.
#[derive(Debug)]
pub struct Spill {
    layout: PageLayout,
    /// Made with the first page; the system removes it with the last handle.
    file: Option<File>,
    /// Where in the file each page begins.
    offsets: HashMap<PageKey, u64>,
    /// Places in the file whose page was taken back.
    free: Vec<u64>,
    end: u64,
}

impl Spill {
    /// Puts nothing aside yet.
    #[must_use]
    pub fn new(layout: PageLayout) -> Self {
        Self { layout, file: None, offsets: HashMap::new(), free: Vec::new(), end: 0 }
    }

    /// Puts a page aside.
    ///
    /// # Errors
    /// [`Error::Spill`] when the temporary file cannot be made or written.
    pub fn put(&mut self, key: PageKey, page: &Page) -> Result<()> {
        let file = match &mut self.file {
            Some(file) => file,
            none => none.insert(tempfile::tempfile().map_err(failed)?),
        };
        let offset = self.free.pop().unwrap_or(self.end);
        file.seek(SeekFrom::Start(offset)).map_err(failed)?;
        file.write_all(bytemuck::cast_slice(page.samples())).map_err(failed)?;
        self.end = self.end.max(offset + self.layout.size_in_bytes());
        if let Some(replaced) = self.offsets.insert(key, offset) {
            self.free.push(replaced);
        }
        Ok(())
    }

    /// Takes a page back; `None` where there is none.
    ///
    /// # Errors
    /// [`Error::Spill`] when the temporary file cannot be read.
    pub fn take(&mut self, key: &PageKey) -> Result<Option<Page>> {
        let (Some(offset), Some(file)) = (self.offsets.remove(key), &mut self.file) else { return Ok(None) };
        let mut samples = vec![0.0_f32; self.layout.num_samples()];
        file.seek(SeekFrom::Start(offset)).map_err(failed)?;
        file.read_exact(bytemuck::cast_slice_mut(&mut samples)).map_err(failed)?;
        self.free.push(offset);
        Ok(Some(Page::from_samples(self.layout, samples)?))
    }

    /// Forgets all pages.
    pub fn clear(&mut self) {
        *self = Self::new(self.layout);
    }
}

fn failed(source: std::io::Error) -> Error {
    Error::Spill { source }
}

#[cfg(test)]
mod tests {
    use super::*;
    use orogeny_field::FieldId;

    #[test]
    fn pages_come_back_as_they_were_and_their_places_are_used_again() {
        let layout = PageLayout::new(64).unwrap();
        let key = |x| PageKey::full_resolution(FieldId(1), x, 0);
        let page = |x: u32| Page::constant(layout, x as f32);
        let mut spill = Spill::new(layout);
        assert_eq!(spill.take(&key(0)).unwrap(), None);
        for round in 0..3 {
            for x in 0..5 {
                spill.put(key(x), &page(x + round)).unwrap();
            }
            for x in [3, 0, 4] {
                assert_eq!(spill.take(&key(x)).unwrap(), Some(page(x + round)));
                assert_eq!(spill.take(&key(x)).unwrap(), None);
            }
        }
        assert!(spill.end <= 8 * layout.size_in_bytes());
        spill.clear();
        assert_eq!(spill.take(&key(1)).unwrap(), None);
    }
}
