//! One run of commits, undos and redos for a child to make, and what the terrain is after each step.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use orogeny_field::{FieldId, Page, PageKey};
use orogeny_store::{EntryState, Error, NewLayer, Result, Store};

use crate::kill::{adds_layer, painted};
use crate::support::{acknowledge, create};

/// How the terrain is called in its folder.
pub const TERRAIN: &str = "t.orogeny";

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    Paint,
    Undo,
    Redo,
    /// The next step opens it again.
    Close,
}

/// Undoes, redoes, leaves a branch behind, starts a second log half-way, adds a layer.
pub const STEPS: [Step; 14] = {
    use Step::{Close, Paint, Redo, Undo};
    [Paint, Paint, Undo, Redo, Paint, Undo, Undo, Paint, Close, Paint, Undo, Redo, Paint, Close]
};

/// Enough commits for SQLite to begin its log anew without being told to.
pub fn long_log() -> Vec<Step> {
    [vec![Step::Paint; 62], vec![Step::Undo; 2], vec![Step::Close]].concat()
}

/// Everything that a reader of a terrain can see.
#[derive(PartialEq)]
pub struct State {
    pages: BTreeMap<PageKey, Page>,
    entries: Vec<(u32, EntryState, String)>,
    layers: Vec<(String, f32)>,
}

/// The history as it has to be, kept without the store.
#[derive(Debug, Clone, Default)]
pub struct Model {
    applied: Vec<u32>,
    undone: Vec<u32>,
    last: u32,
}

impl Model {
    pub fn after(steps: &[Step]) -> Self {
        let mut model = Self::default();
        for step in steps {
            model.take(*step);
        }
        model
    }

    pub fn take(&mut self, step: Step) {
        match step {
            Step::Paint => {
                self.last += 1;
                self.applied.push(self.last);
                // They stay in the history, as a branch.
                self.undone.clear();
            }
            Step::Undo => self.undone.push(self.applied.pop().unwrap()),
            Step::Redo => self.applied.push(self.undone.pop().unwrap()),
            Step::Close => {}
        }
    }

    pub fn state(&self, field: FieldId) -> State {
        let state_of = |id: &u32| match (self.applied.contains(id), self.undone.contains(id)) {
            (true, _) => EntryState::Applied,
            (false, true) => EntryState::Undone,
            (false, false) => EntryState::Branch,
        };
        let new_layers = self.applied.iter().filter(|id| adds_layer(**id)).map(|id| new_layer(*id));
        State {
            pages: self.applied.iter().flat_map(|id| painted(field, *id)).collect(),
            entries: (1..=self.last).map(|id| (id, state_of(&id), operation(id))).collect(),
            layers: std::iter::once(("Base".to_owned(), 0.0))
                .chain(new_layers.map(|layer| (layer.name, layer.constant_m)))
                .collect(),
        }
    }
}

/// What the terrain is after each number of steps; the first is that of [`new_terrain`].
pub fn states(field: FieldId, steps: &[Step]) -> Vec<State> {
    (0..=steps.len()).map(|num_steps| Model::after(&steps[..num_steps]).state(field)).collect()
}

/// A closed terrain in `folder`, its path and its one field.
pub fn new_terrain(folder: &Path) -> (PathBuf, FieldId) {
    let path = folder.join(TERRAIN);
    let store = create(&path);
    let field = store.layers()[0].heights;
    store.close().unwrap();
    (path, field)
}

/// Reads everything.
pub fn read(store: &Store) -> Result<State> {
    let mut pages = BTreeMap::new();
    for layer in store.layers() {
        // What is above full resolution is compared with it by the check.
        for key in store.page_keys(layer.heights)?.into_iter().filter(|key| key.level == 0) {
            pages.extend(store.load_page(&key)?.map(|page| (key, Arc::unwrap_or_clone(page))));
        }
    }
    let entries = store.log()?.into_iter().map(|entry| (entry.id.0, entry.state, entry.operation_json));
    let layers = store.layers().iter().map(|layer| (layer.name.clone(), layer.constant_m));
    Ok(State { pages, entries: entries.collect(), layers: layers.collect() })
}

/// Opens, checks and reads a terrain; the first thing that is wrong with it, if anything is.
pub fn reopen(path: &Path) -> Result<State, String> {
    let name = |err: Error| format!("{err:?}");
    let store = Store::open(path).map_err(name)?;
    let report = store.check().map_err(name)?;
    if !report.problems.is_empty() {
        return Err(format!("{:?}", report.problems));
    }
    read(&store).map_err(name)
}

/// What a child does: every step, each acknowledged as `step NUMBER`.
///
/// A step that fails is reported as `error NUMBER KIND` and ends the run, but for one further commit by the same store:
/// `further committed`, `further committed by another` store where that one is gone, or `further refused KIND`.
pub fn run(path: &Path, steps: &[Step]) {
    let mut store = None;
    for (index, step) in steps.iter().enumerate() {
        let number = index + 1;
        if let Err(err) = take(&mut store, path, *step) {
            acknowledge(&format!("error {number} {}", kind(&err)));
            // One that failed to open or to close is gone.
            let by_whom = if store.is_some() { "" } else { " by another" };
            match take(&mut store, path, Step::Paint) {
                Ok(()) => acknowledge(&format!("further committed{by_whom}")),
                Err(err) => acknowledge(&format!("further refused {}", kind(&err))),
            }
            return;
        }
        acknowledge(&format!("step {number}"));
    }
}

fn take(store: &mut Option<Store>, path: &Path, step: Step) -> Result<()> {
    if step == Step::Close {
        return store.take().map_or(Ok(()), Store::close);
    }
    let store = match store {
        Some(store) => store,
        None => store.insert(Store::open(path)?),
    };
    match step {
        Step::Paint => paint(store),
        Step::Undo => store.undo(1).map(|changes| assert_eq!(changes.len(), 1)),
        Step::Redo => store.redo(1).map(|changes| assert_eq!(changes.len(), 1)),
        Step::Close => Ok(()),
    }
}

fn paint(store: &mut Store) -> Result<()> {
    let id = store.log()?.last().map_or(0, |entry| entry.id.0) + 1;
    let field = store.layers()[0].heights;
    let mut transaction = store.begin()?;
    transaction.write_pages(&painted(field, id))?;
    if adds_layer(id) {
        transaction.add_layer(&new_layer(id))?;
    }
    transaction.commit(&operation(id), "child").map(drop)
}

fn new_layer(id: u32) -> NewLayer {
    NewLayer { name: format!("Layer {id}"), constant_m: 1.0 }
}

fn operation(id: u32) -> String {
    format!("{{\"number\": {id}}}")
}

/// The name of an error's variant.
fn kind(err: &Error) -> String {
    format!("{err:?}").split([' ', '(']).next().unwrap_or_default().to_owned()
}

/// How many steps a child acknowledged.
pub fn num_steps(lines: &[String]) -> usize {
    lines.iter().filter(|line| line.starts_with("step ")).count()
}
