use super::*;
use plan_format::mission::Label::{NB, NM, NS, PB, PM, PS, ZO};
use proptest::prelude::*;

extern crate std;

const REFUEL: [Label; 7] = [PB, PB, PM, PM, NB, NB, NB];
const PLOUGH: [Label; 7] = [PS, PS, PS, PS, PS, PS, NB];
const VISIBILITY: [Label; 7] = [NB, NB, NB, NS, PS, PS, PB];
const ROAD: [Label; 7] = [PB, PS, PS, ZO, NS, NM, NB];
const LOAD: [Label; 7] = [PB, PB, PS, ZO, NS, NS, NB];

fn one(labels: [Label; 7], position: f32, inference: Inference) -> f32 {
    infer(core::iter::once((labels.into(), position)), inference)
}

#[track_caller]
fn close(value: f32, expected: f32) {
    assert!((value - expected).abs() < 1e-3, "{value} instead of {expected}");
}

/// H40: golden values of tables 3, 4 and 5, computed independently.
#[test]
fn h40_golden_values() {
    for (label, centre) in [(NB, 0.0556), (PS, 0.6667), (PM, 0.8333), (PB, 0.9444)] {
        for inference in [Inference::Min, Inference::Product] {
            close(one([label; 7], 0.0, inference), centre);
        }
    }
    let refuel = [
        (0.0, 0.9445, 0.9445),
        (0.08, 0.9358, 0.9445),
        (1.0 / 6.0, 0.9444, 0.9444),
        (0.2, 0.8909, 0.9086),
        (0.25, 0.8532, 0.8611),
        (0.3, 0.8365, 0.8371),
        (1.0 / 3.0, 0.8333, 0.8333),
        (0.5, 0.8333, 0.8333),
        (0.55, 0.6666, 0.6960),
        (0.6, 0.5276, 0.4999),
        (2.0 / 3.0, 0.0555, 0.0555),
        (1.0, 0.0555, 0.0555),
    ];
    for (fuel, min, product) in refuel {
        close(one(REFUEL, fuel, Inference::Min), min);
        close(one(REFUEL, fuel, Inference::Product), product);
    }
    for inference in [Inference::Min, Inference::Product] {
        close(one(PLOUGH, 0.0, inference), 0.6667);
        close(one(PLOUGH, 5.0 / 6.0, inference), 0.6667);
        close(one(PLOUGH, 1.0, inference), 0.0555);
    }
    let drive = [
        ([0.0, 0.0, 0.0], 0.6482, 0.6482),
        ([0.5, 0.5, 0.5], 0.4444, 0.4444),
        ([1.0, 1.0, 1.0], 0.3518, 0.3518),
        ([1.0, 0.0, 0.0], 0.9445, 0.9445),
        ([0.0, 1.0, 1.0], 0.0555, 0.0555),
        ([0.3, 0.6, 0.45], 0.4095, 0.3950),
    ];
    for (at, min, product) in drive {
        let rules = || [VISIBILITY, ROAD, LOAD].map(Row::from).into_iter().zip(at);
        close(infer(rules(), Inference::Min), min);
        close(infer(rules(), Inference::Product), product);
    }
}

/// H40: the fuel levels at which refuelling overtakes ploughing and becomes unconditional.
#[test]
fn h40_crossings_of_the_ploughing_example() {
    let first_at = |inference, holds: &dyn Fn(f32) -> bool| {
        let step = |i: i32| 1.0 - i as f32 * 1e-4;
        step((0..10_000).find(|&i| holds(one(REFUEL, step(i), inference))).unwrap())
    };
    for (inference, overtakes, unconditional) in
        [(Inference::Min, 0.549, 0.192), (Inference::Product, 0.558, 0.2075)]
    {
        close(first_at(inference, &|criticality| criticality > 0.6667), overtakes);
        close(first_at(inference, &|criticality| criticality >= 0.90), unconditional);
    }
}

/// The inference by its definition: sampled membership, maximum within an input, sum over inputs.
fn sampled(rules: &[([Label; 7], f32)], inference: Inference) -> f64 {
    const SAMPLES: u32 = 6_000;
    let triangle = |label: usize, at: f64| (1.0 - (at * 6.0 - label as f64).abs()).max(0.0);
    let (mut area, mut moment) = (0.0, 0.0);
    for i in 0..SAMPLES {
        let y = (f64::from(i) + 0.5) / f64::from(SAMPLES);
        let mut sum = 0.0;
        for (labels, position) in rules {
            let cut = |(premise, &label): (usize, &Label)| {
                let degree = triangle(premise, f64::from(*position));
                match inference {
                    Inference::Min => degree.min(triangle(label as usize, y)),
                    Inference::Product => degree * triangle(label as usize, y),
                }
            };
            sum += labels.iter().enumerate().map(cut).fold(0.0, f64::max);
        }
        area += sum;
        moment += sum * y;
    }
    moment / area
}

fn labels() -> impl Strategy<Value = [Label; 7]> {
    prop::array::uniform7((0_u8..7).prop_map(Label::from_index))
}

fn inference() -> impl Strategy<Value = Inference> {
    prop_oneof![Just(Inference::Min), Just(Inference::Product)]
}

proptest! {
    /// The closed form against a fine numerical integration.
    #[test]
    fn h40_closed_form_equals_integration(
        rules in prop::collection::vec((labels(), 0.0_f32..=1.0), 1..5),
        inference in inference(),
    ) {
        let exact = infer(rules.iter().map(|&(row, at)| (row.into(), at)), inference);
        prop_assert!((f64::from(exact) - sampled(&rules, inference)).abs() < 1e-4);
    }

    /// P17: any input gives a number between the ends.
    #[test]
    fn p17_the_result_is_always_within_one_eighteenth_of_the_ends(
        rules in prop::collection::vec((labels(), any::<f32>()), 1..5),
        inference in inference(),
    ) {
        let result = infer(rules.into_iter().map(|(row, at)| (row.into(), at)), inference);
        prop_assert!((1.0 / 18.0 - 1e-5..=17.0 / 18.0 + 1e-5).contains(&result), "{}", result);
    }

    /// With product inference a monotone table gives a monotone result. Min clipping does not: it
    /// dips between NB and NM.
    #[test]
    fn product_is_monotone_where_the_table_is(mut table in labels(), a in 0.0_f32..=1.0, b in 0.0_f32..=1.0) {
        table.sort();
        let (low, high) = (a.min(b), a.max(b));
        let (low, high) =
            (one(table, low, Inference::Product), one(table, high, Inference::Product));
        prop_assert!(low <= high + 1e-6, "{} > {}", low, high);
    }

    #[test]
    fn positions_are_cut_at_the_ends(value in any::<f32>(), low in -10.0_f32..0.0, high in 1.0_f32..10.0) {
        let at = position(value, low, high);
        prop_assert!((0.0..=1.0).contains(&at));
        if value.is_finite() {
            prop_assert!((at - (1.0 - position(value, high, low))).abs() < 1e-6);
        }
    }
}

#[test]
fn no_rules_speak_neither_for_nor_against() {
    assert_eq!(infer(core::iter::empty(), Inference::Min), 0.5);
}
