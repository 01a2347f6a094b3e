//! The facts that a component of a draft may change. The compiler and the missions of tests share
//! this.

use super::{Facts, MissionDraft, Symbol};

/// The facts that a component certainly makes true, and false, when it succeeds.
pub fn sure(draft: &MissionDraft, symbol: Symbol) -> (Facts, Facts) {
    let index = match symbol {
        Symbol::PlanFrame(index) => {
            draft.frames.get(usize::from(index)).map(|frame| frame.description)
        }
        Symbol::Action(index) => {
            draft.actions.get(usize::from(index)).map(|action| action.description)
        }
    };
    let description = index.and_then(|index| draft.descriptions.get(usize::from(index)));
    description.map_or((0, 0), |d| (d.add | d.goal.must, d.delete | d.goal.must_not))
}

/// The facts that a component may make true, and false. For frames the result is complete after
/// [`spread`].
pub fn possible(draft: &MissionDraft, symbol: Symbol) -> (Facts, Facts) {
    let (adds, deletes) = sure(draft, symbol);
    match symbol {
        Symbol::Action(_) => (adds, deletes),
        Symbol::PlanFrame(index) => draft
            .frames
            .get(usize::from(index))
            .map_or((adds, deletes), |f| (adds | f.may_add, deletes | f.may_delete)),
    }
}

fn resources(draft: &MissionDraft, symbol: Symbol) -> u16 {
    match symbol {
        Symbol::PlanFrame(index) => draft.frames.get(usize::from(index)).map_or(0, |f| f.resources),
        Symbol::Action(index) => draft.actions.get(usize::from(index)).map_or(0, |a| a.resources),
    }
}

/// Gives every frame the facts and resources that the components below it may change and occupy.
/// Frames may contain each other, so this is repeated until nothing changes; each round but the
/// last adds a bit.
pub fn spread(draft: &mut MissionDraft) {
    loop {
        let mut has_grown = false;
        for index in 0..draft.frames.len() {
            let frame = draft.frames[index];
            let (mut adds, mut deletes) = possible(draft, Symbol::PlanFrame(index as u16));
            let mut used = frame.resources;
            for symbol in below(draft, index) {
                let (more, less) = possible(draft, symbol);
                (adds, deletes) = (adds | more, deletes | less);
                used |= resources(draft, symbol);
            }
            let frame = &mut draft.frames[index];
            has_grown |=
                (frame.may_add, frame.may_delete, frame.resources) != (adds, deletes, used);
            (frame.may_add, frame.may_delete, frame.resources) = (adds, deletes, used);
        }
        if !has_grown {
            return;
        }
    }
}

/// The components of all productions of a frame.
pub fn below(draft: &MissionDraft, frame: usize) -> Vec<Symbol> {
    let Some(frame) = draft.frames.get(frame) else { return Vec::new() };
    let first = usize::from(frame.first);
    let productions = draft.productions.iter().skip(first).take(usize::from(frame.count));
    productions.flat_map(|production| draft.edges_of(production)).map(|edge| edge.symbol).collect()
}

/// Every component that can occur below a frame, at any depth, once; a frame that can occur below
/// itself too.
pub fn all_below(draft: &MissionDraft, frame: usize) -> Vec<Symbol> {
    let (mut all, mut open) = (Vec::new(), vec![frame]);
    while let Some(frame) = open.pop() {
        for symbol in below(draft, frame) {
            if all.contains(&symbol) {
                continue;
            }
            all.push(symbol);
            if let Symbol::PlanFrame(inner) = symbol {
                open.push(inner.into());
            }
        }
    }
    all
}

/// Whether frame `to` can occur below frame `from`.
pub fn reaches(draft: &MissionDraft, from: usize, to: usize) -> bool {
    all_below(draft, from)
        .iter()
        .any(|symbol| matches!(symbol, Symbol::PlanFrame(index) if usize::from(*index) == to))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mission::{Action, ActionKind, Condition, Description, Edge, PlanFrame, Production};
    use proptest::prelude::*;

    /// Frames and actions, each frame with one production of the given components.
    fn draft(frames: &[Vec<(bool, u16)>], effects: &[(u64, u64, u16)]) -> MissionDraft {
        let mut draft = MissionDraft::default();
        let name = draft.name("x");
        for &(add, delete, resources) in effects {
            draft.descriptions.push(Description {
                initial: Condition::default(),
                transient: Condition::default(),
                goal: Condition { must: add.rotate_left(7), must_not: delete.rotate_left(7) },
                add,
                delete,
                max_speed_mps: f32::INFINITY,
                min_distance_m: 0.0,
            });
            draft.actions.push(Action {
                name,
                kind: ActionKind::Signal { code: 1 },
                description: (draft.descriptions.len() - 1) as u16,
                until: Condition::default(),
                timeout_ms: 1,
                resources,
            });
        }
        for (index, parts) in frames.iter().enumerate() {
            draft.frames.push(PlanFrame {
                name,
                first: index as u16,
                count: 1,
                description: (index % effects.len()) as u16,
                threshold: 0.0,
                until: Condition::default(),
                timeout_ms: 0,
                may_add: 0,
                may_delete: 0,
                resources: 0,
            });
            draft.productions.push(Production {
                name,
                rules: None,
                first_edge: draft.edges.len() as u16,
                edges: parts.len() as u8,
                vertices: 2,
                first_interval: 0,
                intervals: 0,
            });
            for &(is_frame, number) in parts {
                let symbol = if is_frame {
                    Symbol::PlanFrame(number % frames.len() as u16)
                } else {
                    Symbol::Action(number % effects.len() as u16)
                };
                draft.edges.push(Edge { from: 0, to: 1, symbol, work: 0 });
            }
        }
        draft
    }

    /// The reference by definition: visits every reachable component once.
    fn by_search(draft: &MissionDraft, frame: usize) -> (Facts, Facts, u16) {
        let mut seen = vec![Symbol::PlanFrame(frame as u16)];
        let mut at = 0;
        while at < seen.len() {
            if let Symbol::PlanFrame(index) = seen[at] {
                for symbol in below(draft, usize::from(index)) {
                    if !seen.contains(&symbol) {
                        seen.push(symbol);
                    }
                }
            }
            at += 1;
        }
        seen.iter().fold((0, 0, 0), |(adds, deletes, used), &symbol| {
            let (more, less) = sure(draft, symbol);
            let occupies = match symbol {
                Symbol::Action(_) => resources(draft, symbol),
                Symbol::PlanFrame(_) => 0,
            };
            (adds | more, deletes | less, used | occupies)
        })
    }

    proptest! {
        #[test]
        fn what_frames_may_do_is_what_can_be_reached_below_them(
            frames in prop::collection::vec(
                prop::collection::vec((any::<bool>(), 0_u16..8), 1..5), 1..8),
            effects in prop::collection::vec(
                (0_u32..64, 0_u32..64, any::<u16>()), 1..8),
        ) {
            let effects: Vec<_> = effects.iter().map(|&(a, d, r)| (1 << a, 1 << d, r)).collect();
            let mut draft = draft(&frames, &effects);
            let expected: Vec<_> =
                (0..draft.frames.len()).map(|frame| by_search(&draft, frame)).collect();
            spread(&mut draft);
            for (frame, expected) in draft.frames.iter().zip(expected) {
                prop_assert_eq!((frame.may_add, frame.may_delete, frame.resources), expected);
            }
        }
    }
}
