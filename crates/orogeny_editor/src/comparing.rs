//! The terrain as it was, beside how it is.
//!
//! While it is compared, the terrain *is* at the earlier entry, and nothing is done to it there; afterwards it is where it was, bit for
//! bit. Should the program end meanwhile, the next start goes back by what preferences remember.

use orogeny_engine::session::{HistoryItem, Travel};
use orogeny_engine::{EntryId, EntryState};

use crate::editor::Editor;

/// What is told where something is to be changed meanwhile.
const NOT_NOW: &str = "the terrain is shown as it was: go back to now (V or Esc), then change it";

impl Editor {
    /// Whether what is open may be changed; tells people where not.
    pub(crate) fn may_change(&mut self) -> bool {
        let may = self.document.as_ref().is_some_and(|document| document.now.is_none());
        if !may && self.document.is_some() {
            self.tell(NOT_NOW, false);
        }
        may
    }

    /// Whether the terrain is shown as it was.
    #[must_use]
    pub fn is_comparing(&self) -> bool {
        self.document.as_ref().is_some_and(|document| document.now.is_some())
    }

    /// Shows the terrain as it was before the last entry, or as it is again.
    pub(crate) fn toggle_comparing(&mut self) {
        if self.is_comparing() {
            return self.end_comparing();
        }
        let Some(document) = &self.document else { return };
        let current = document.status.current_entry();
        let before = document.status.history.iter().find(|item| item.id == current).map(|item| item.parent);
        match before {
            Some(before) => self.compare_with(before),
            None => self.tell("there is nothing before this to compare with", false),
        }
    }

    /// Shows the terrain as it was after an entry.
    pub(crate) fn compare_with(&mut self, entry: EntryId) {
        let Some(document) = &mut self.document else { return };
        // What is under way changes what now is.
        if !document.jobs.is_empty() {
            return self.tell("wait until what is under way is done, then compare", false);
        }
        let current = document.status.current_entry();
        let now = *document.now.get_or_insert(current);
        if now == current {
            document.overview.begin_comparing(&document.session);
        }
        self.preferences.comparing.insert(document.path.clone(), now.0);
        self.remember();
        self.go("compare", Travel::Jump(entry));
    }

    /// After a start: goes back to what a program that ended meanwhile remembers, unless something else was done since.
    pub(crate) fn go_back_to_remembered(&mut self) {
        let Some(document) = &self.document else { return };
        let Some(now) = self.preferences.comparing.get(&document.path).copied().map(EntryId) else { return };
        let is_undone = |item: &HistoryItem| item.id == now && item.state == EntryState::Undone;
        if document.status.history.iter().any(is_undone) {
            self.go("go back to now", Travel::Jump(now));
        }
    }

    /// Forgets where to go back to, once it is there.
    pub(crate) fn forget_comparing(&mut self) {
        if let Some(document) = &self.document
            && document.now.is_none()
            && document.jobs.is_empty()
        {
            self.preferences.comparing.remove(&document.path);
        }
    }

    /// Shows the terrain as it is.
    pub(crate) fn end_comparing(&mut self) {
        let Some(document) = &mut self.document else { return };
        let Some(now) = document.now.take() else { return };
        document.overview.end_comparing();
        self.go("go back to now", Travel::Jump(now));
    }
}
