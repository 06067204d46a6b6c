//! Random operations, undo, redo and reopening, compared with a model that keeps every state whole.

use std::collections::BTreeMap;

use orogeny_field::{FieldId, Page, PageKey};
use orogeny_store::{EntryId, EntryState, Layer, Store};
use proptest::prelude::*;

use crate::support::{Scratch, assert_whole, bits, contents, layer, layout, page, painted};

#[derive(Debug, Clone)]
enum Content {
    /// What an absent page holds.
    Constant,
    Painted(u32),
    /// What is there, with one sample changed.
    Touched {
        sample: usize,
        bits: u32,
    },
    /// What was there before the transaction.
    AsBefore,
}

#[derive(Debug, Clone)]
struct PageWrite {
    layer: prop::sample::Index,
    x: u32,
    z: u32,
    content: Content,
}

#[derive(Debug, Clone)]
enum Step {
    Operation { rounds: Vec<Vec<PageWrite>>, adds_layer: bool, is_dropped: bool },
    Undo(u32),
    Redo(u32),
    Jump(prop::sample::Index),
    Reopen,
}

fn content() -> impl Strategy<Value = Content> {
    // Any bits within ±1e7, of either sign; denormals and -0 too.
    let storable =
        (0..=1.0e7_f32.to_bits(), any::<bool>()).prop_map(|(b, negative)| b | u32::from(negative) << 31);
    prop_oneof![
        1 => Just(Content::Constant),
        3 => (0_u32..50).prop_map(Content::Painted),
        3 => (0_usize..4096, storable).prop_map(|(sample, bits)| Content::Touched { sample, bits }),
        1 => Just(Content::AsBefore),
    ]
}

fn step() -> impl Strategy<Value = Step> {
    let write = (any::<prop::sample::Index>(), 0_u32..5, 0_u32..3, content())
        .prop_map(|(layer, x, z, content)| PageWrite { layer, x, z, content });
    let rounds = prop::collection::vec(prop::collection::vec(write, 0..5), 1..4);
    prop_oneof![
        5 => (rounds, prop::bool::weighted(0.2), prop::bool::weighted(0.15))
            .prop_map(|(rounds, adds_layer, is_dropped)| Step::Operation { rounds, adds_layer, is_dropped }),
        2 => (1_u32..4).prop_map(Step::Undo),
        2 => (1_u32..4).prop_map(Step::Redo),
        1 => any::<prop::sample::Index>().prop_map(Step::Jump),
        1 => Just(Step::Reopen),
    ]
}

/// The terrain after an entry.
#[derive(Debug, Clone, PartialEq)]
struct State {
    layers: Vec<Layer>,
    pages: BTreeMap<PageKey, Vec<u32>>,
}

struct ModelEntry {
    parent: usize,
    next: Option<usize>,
    state: State,
}

struct Model {
    entries: Vec<ModelEntry>,
    head: usize,
}

impl Model {
    fn state(&self) -> &State {
        &self.entries[self.head].state
    }

    fn commit(&mut self, state: State) {
        let id = self.entries.len();
        self.entries[self.head].next = Some(id);
        self.entries.push(ModelEntry { parent: self.head, next: None, state });
        self.head = id;
    }

    fn undo(&mut self, count: u32) -> usize {
        let undone = (0..count).take_while(|_| {
            let can = self.head > 0;
            self.head = self.entries[self.head].parent;
            can
        });
        undone.count()
    }

    fn redo(&mut self, count: u32) -> usize {
        let redone = (0..count).take_while(|_| match self.entries[self.head].next {
            Some(next) => {
                self.head = next;
                true
            }
            None => false,
        });
        redone.count()
    }

    fn jump(&mut self, target: usize) {
        self.head = target;
        let path = self.applied();
        for (parent, child) in std::iter::once(&0).chain(&path).zip(&path) {
            self.entries[*parent].next = Some(*child);
        }
    }

    fn applied(&self) -> Vec<usize> {
        let mut path = Vec::new();
        let mut at = self.head;
        while at != 0 {
            path.push(at);
            at = self.entries[at].parent;
        }
        path.reverse();
        path
    }
}

fn page_from_bits(bits: &[u32]) -> Page {
    Page::from_samples(layout(), bits.iter().map(|b| f32::from_bits(*b)).collect()).unwrap()
}

/// Runs an operation on the store, and gives the state that it must leave.
fn operate(
    store: &mut Store,
    before: &State,
    rounds: &[Vec<PageWrite>],
    adds_layer: bool,
    is_dropped: bool,
) -> State {
    let mut state = before.clone();
    let mut transaction = store.begin().unwrap();
    if adds_layer {
        state.layers.push(transaction.add_layer(&layer("More", 3.5)).unwrap());
    }
    for round in rounds {
        let mut pages = BTreeMap::new();
        for write in round {
            let layer = &state.layers[write.layer.index(state.layers.len())];
            let key = PageKey::full_resolution(layer.heights, write.x, write.z);
            let constant = bits(&Page::constant(layout(), layer.constant_m));
            let now = state.pages.get(&key).unwrap_or(&constant).clone();
            let new = match &write.content {
                Content::Constant => constant.clone(),
                Content::Painted(seed) => bits(&page(*seed)),
                Content::Touched { sample, bits } => {
                    let mut touched = now;
                    touched[*sample] = *bits;
                    touched
                }
                Content::AsBefore => before.pages.get(&key).unwrap_or(&constant).clone(),
            };
            pages.insert(key, (new, constant));
        }
        let written: Vec<_> = pages.iter().map(|(key, (new, _))| (*key, page_from_bits(new))).collect();
        transaction.write_pages(&written).unwrap();
        for (key, (new, constant)) in pages {
            let was_absent = !before.pages.contains_key(&key);
            if was_absent && new == constant {
                state.pages.remove(&key);
            } else {
                state.pages.insert(key, new);
            }
            let now = transaction.load_page(&key).unwrap().map(|page| bits(&page));
            assert_eq!(now.as_ref(), state.pages.get(&key));
            let then = transaction.load_page_before(&key).unwrap().map(|page| bits(&page));
            assert_eq!(then.as_ref(), before.pages.get(&key));
        }
    }
    if is_dropped {
        return before.clone();
    }
    transaction.commit("{}", "model").unwrap();
    state
}

fn assert_same(store: &Store, model: &Model) {
    let expected = model.state();
    assert_eq!(store.layers(), expected.layers);
    let fields: Vec<FieldId> = expected.layers.iter().map(|layer| layer.heights).collect();
    let found: Vec<_> = fields.iter().flat_map(|field| painted(store, *field)).collect();
    assert_eq!(found, expected.pages.clone().into_iter().collect::<Vec<_>>());
    let log = store.log().unwrap();
    assert_eq!(log.len(), model.entries.len() - 1);
    let applied = log.iter().filter(|e| e.state == EntryState::Applied).map(|e| e.id.0 as usize);
    assert_eq!(applied.collect::<Vec<_>>(), model.applied());
    let redoable = log.iter().filter(|e| e.state == EntryState::Undone).count();
    let mut at = model.head;
    let next = std::iter::from_fn(|| {
        at = model.entries[at].next?;
        Some(at)
    });
    assert_eq!(redoable, next.count());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn the_store_is_what_the_model_is(steps in prop::collection::vec(step(), 1..24)) {
        let scratch = Scratch::new();
        let mut store = scratch.create();
        let start = State { layers: store.layers().to_vec(), pages: BTreeMap::new() };
        let mut model = Model { entries: vec![ModelEntry { parent: 0, next: None, state: start }], head: 0 };
        for step in steps {
            match step {
                Step::Operation { rounds, adds_layer, is_dropped } => {
                    let state = operate(&mut store, model.state(), &rounds, adds_layer, is_dropped);
                    if !is_dropped {
                        model.commit(state);
                    }
                }
                Step::Undo(count) => prop_assert_eq!(store.undo(count).unwrap().len(), model.undo(count)),
                Step::Redo(count) => prop_assert_eq!(store.redo(count).unwrap().len(), model.redo(count)),
                Step::Jump(target) => {
                    let target = target.index(model.entries.len());
                    store.jump(EntryId(target as u32)).unwrap();
                    model.jump(target);
                }
                Step::Reopen => {
                    store.close().unwrap();
                    store = Store::open(&scratch.path()).unwrap();
                }
            }
            assert_same(&store, &model);
        }
        assert_whole(&store);
        store.undo(u32::MAX).unwrap();
        prop_assert_eq!(&contents(&store, model.entries[0].state.layers[0].heights), &[]);
    }
}
