use std::collections::{BTreeMap, BTreeSet};

use orogeny_engine::session::{Event, Session};
use orogeny_engine::{Adapter, Settings, Terrain, TerrainGrid};
use proptest::prelude::*;

use super::*;

/// The status of a terrain of 700 × 600 samples, 2 m apart, from a session of its own.
fn status() -> Status {
    let folder = tempfile::tempdir().unwrap();
    let settings = Settings { adapter: Adapter::Cpu, page_budget_in_bytes: 64 << 20, ..Settings::default() };
    let grid = TerrainGrid::new(700, 600, 2.0).unwrap();
    let terrain = Terrain::create(&folder.path().join("t.orogeny"), grid, 0.0, settings).unwrap();
    let session = Session::of(terrain, || {}).unwrap();
    loop {
        for event in session.events() {
            if let Event::Status(status) = event {
                return *status;
            }
        }
        std::thread::yield_now();
    }
}

const fn wish(region_m: Option<[f64; 4]>, level: u8, window: u32) -> Wish {
    Wish { region_m, level, format: FrameFormat::R32, window }
}

#[test]
fn pages_are_those_that_the_region_touches() {
    let status = status();
    let pages = |region_m: Option<[f64; 4]>, level: u8| {
        let mut subscription = Subscription::new(wish(region_m, level, 100), &status, 100).unwrap();
        subscription.ask(0, 100).into_iter().map(|place| (place.z, place.x)).collect::<Vec<_>>()
    };
    assert_eq!(pages(None, 0).len(), 9);
    assert_eq!(pages(None, 2), [(0, 0)]);
    // Page borders lie at 512 and 1024 m.
    assert_eq!(pages(Some([500.0, 500.0, 12.0, 12.0]), 0), [(0, 0)]);
    assert_eq!(pages(Some([500.0, 500.0, 13.0, 12.0]), 0), [(0, 0), (0, 1)]);
    assert_eq!(pages(Some([-100.0, -100.0, 5000.0, 150.0]), 1), [(0, 0), (0, 1)]);
    let code = |region_m, level, max_pages| {
        Subscription::new(wish(region_m, level, 1), &status, max_pages).unwrap_err().code
    };
    assert_eq!(code(None, 0, 8), "too_many_pages");
    assert_eq!(code(None, 3, 8), "unknown_level");
    assert_eq!(code(Some([1400.0, 0.0, 10.0, 10.0]), 0, 8), "region");
    assert_eq!(code(Some([f64::NAN, 0.0, 10.0, 10.0]), 0, 8), "region");
}

/// What happens to a subscription.
#[derive(Debug, Clone)]
enum Step {
    Change { x: i32, z: i32, side: i32 },
    ChangeAll,
    Ask(usize),
    Arrive,
    Acknowledge,
}

fn step() -> impl Strategy<Value = Step> {
    prop_oneof![
        4 => (-50..750, -50..650, 0..400).prop_map(|(x, z, side)| Step::Change { x, z, side }),
        1 => Just(Step::ChangeAll),
        4 => (1_usize..8).prop_map(Step::Ask),
        6 => Just(Step::Arrive),
        3 => Just(Step::Acknowledge),
    ]
}

proptest! {
    /// Whatever happens: no more frames are under way than the window, no page is asked for twice at once, and when all is quiet the client
    /// has every page as it is.
    #[test]
    fn a_client_ends_with_every_page_as_it_is(steps in proptest::collection::vec(step(), 0..120), window in 1_u32..6) {
        let status = status_once();
        let mut subscription = Subscription::new(wish(None, 0, window), status, 100).unwrap();
        // How often each page changed, and what of that the client has.
        let mut now: BTreeMap<(u32, u32), u32> = (0..3).flat_map(|z| (0..3).map(move |x| ((z, x), 1))).collect();
        let mut has: BTreeMap<(u32, u32), u32> = BTreeMap::new();
        let mut asked: VecDeque<PagePlace> = VecDeque::new();
        let (mut sent, mut acknowledged) = (0_u64, 0_u64);
        let quiet = std::iter::repeat_n([Step::Acknowledge, Step::Ask(8), Step::Arrive], 40).flatten();
        for step in steps.into_iter().chain(quiet) {
            match step {
                Step::Change { x, z, side } => {
                    let rect = SampleRect::new(x, z, x + side, z + side);
                    subscription.change(&[rect, SampleRect::EMPTY], 256);
                    for (place, changes) in &mut now {
                        let page = SampleRect::new(
                            place.1 as i32 * 256, place.0 as i32 * 256, place.1 as i32 * 256 + 256, place.0 as i32 * 256 + 256,
                        );
                        *changes += u32::from(!page.intersection(&rect).is_empty());
                    }
                }
                Step::ChangeAll => {
                    subscription.change_all();
                    now.values_mut().for_each(|changes| *changes += 1);
                }
                Step::Ask(at_most) => {
                    let pages = subscription.ask(sent - acknowledged, at_most);
                    prop_assert!(pages.len() <= at_most);
                    asked.extend(pages);
                    let distinct: BTreeSet<_> = asked.iter().collect();
                    prop_assert_eq!(distinct.len(), asked.len(), "asked for twice at once");
                    prop_assert!(sent - acknowledged + asked.len() as u64 <= u64::from(window));
                }
                Step::Arrive => {
                    if let Some(place) = asked.pop_front() {
                        prop_assert!(subscription.arrive(place));
                        prop_assert!(!subscription.arrive(place), "it came, and is wanted again");
                        has.insert((place.z, place.x), now[&(place.z, place.x)]);
                        sent += 1;
                    }
                }
                Step::Acknowledge => acknowledged = sent,
            }
            prop_assert!(subscription.num_queued() <= 9);
        }
        prop_assert_eq!(has, now);
    }
}

fn status_once() -> &'static Status {
    static STATUS: std::sync::OnceLock<Status> = std::sync::OnceLock::new();
    STATUS.get_or_init(status)
}
