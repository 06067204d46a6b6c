//! Back and forth in what was done, and what of it is kept.

use orogeny_store::{Change, Dropped, Entry, EntryId, Recorder, Store};

use crate::{Result, Terrain};

impl Terrain {
    /// Undoes up to `count` operations, bit for bit; fewer where the history begins.
    ///
    /// # Errors
    /// [`crate::Error::Store`]; the terrain is then as it was.
    pub fn undo(&mut self, count: u32) -> Result<Vec<Change>> {
        self.travel(|recorder| recorder.undo(count))
    }

    /// Does up to `count` undone operations again, bit for bit.
    ///
    /// # Errors
    /// [`crate::Error::Store`]; the terrain is then as it was.
    pub fn redo(&mut self, count: u32) -> Result<Vec<Change>> {
        self.travel(|recorder| recorder.redo(count))
    }

    /// Goes to any entry of the history, on a branch too: afterwards it is the last one that shows.
    ///
    /// # Errors
    /// [`crate::Error::Store`] when there is none of that number, and as [`Self::undo`].
    pub fn jump(&mut self, entry: EntryId) -> Result<Vec<Change>> {
        self.travel(|recorder| recorder.jump(entry))
    }

    fn travel(
        &mut self,
        travel: impl FnOnce(&mut Recorder) -> orogeny_store::Result<Vec<Change>>,
    ) -> Result<Vec<Change>> {
        // A commit that failed meanwhile takes its pages back.
        self.flush()?;
        let travelled = travel(self.recorder()?);
        if travelled.is_err() {
            // Whether it came to pass or not.
            self.forget_all_pages();
        }
        let changes = travelled?;
        changes.iter().for_each(|change| self.forget_pages(&change.pages));
        Ok(changes)
    }

    /// What was done, oldest first, with what was undone and what was left behind.
    ///
    /// # Errors
    /// [`crate::Error::Store`] when the history cannot be read.
    pub fn log(&self) -> Result<Vec<Entry>> {
        Ok(self.settled()?.log()?)
    }

    /// Sets how many bytes of the file the history may take; `None`: whatever it comes to. The oldest entries over it go at
    /// once, and from now on with each operation.
    ///
    /// # Errors
    /// [`crate::Error::Store`]; nothing is changed then.
    pub fn set_history_budget(&mut self, budget_in_bytes: Option<u64>) -> Result<Dropped> {
        self.flush()?;
        Ok(self.recorder()?.with_store(move |store| store.set_history_budget(budget_in_bytes))?)
    }

    /// Drops everything that was undone and left behind.
    ///
    /// # Errors
    /// [`crate::Error::Store`]; nothing is changed then.
    pub fn drop_branches(&mut self) -> Result<Dropped> {
        self.flush()?;
        Ok(self.recorder()?.with_store(Store::drop_branches)?)
    }

    /// Gives free space in the file back, and tells its size in bytes before and after.
    ///
    /// # Errors
    /// [`crate::Error::Store`]; nothing is changed then.
    pub fn compact(&mut self) -> Result<(u64, u64)> {
        self.flush()?;
        Ok(self.recorder()?.with_store(Store::compact)?)
    }

    /// What had to go from the history since this was last asked, for it to keep to its budget.
    ///
    /// # Errors
    /// [`crate::Error::Store`] for a terrain that is open for reading.
    pub fn take_dropped_history(&mut self) -> Result<Dropped> {
        Ok(self.recorder()?.take_dropped())
    }
}
